// Pictures of sharp rims and silhouettes against one sixteen times as fine that is convolved with the same
// filter, where sixteen samples a pixel are off by more than the tolerance.
#include "host/render/refinement.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "host/job/job.h"
#include "host/render/render.h"
#include "tests/render/fine_picture.h"
#include "tests/temporary_path.h"

namespace mica::host::refinement_test {
namespace {

std::string rim_job() {
  const std::string path = temporary_path("refinement_test.toml");
  std::ofstream(path) << R"(
image = { width = 40, height = 32, subpixels = 4 }
camera = { position = [0, -3.2, 1.4], look_at = [0.4, 0, 0.5], fov = 5 }
surface.m = { generate = "spectrum", resolution = 256, rms_slope = 0.3, correlation = 8, seed = 1 }
material.a = { surface = "m", repeat = [6, 6], roughness = 0.02, ndf = "triangles" }
shape = [{ type = "shell", material = "a" }]
light = [{ type = "point", position = [1.6, -3.6, 3.4], intensity = [25, 25, 25] }]
)";
  return path;
}

/// The lip of the shell, over which half vectors turn by a hundred lobes within a pixel, and which hides the
/// lamp from what lies behind it.
std::string lip_job() {
  const std::string path = temporary_path("refinement_lip_test.toml");
  std::ofstream(path) << R"(
image = { width = 16, height = 14, subpixels = 4 }
camera = { position = [0.34, -3.17, 1.46], look_at = [0.405, -0.288, 0.568], fov = 7 }
surface.m = { generate = "spectrum", resolution = 512, rms_slope = 0.3, correlation = 8, seed = 1 }
material.a = { surface = "m", repeat = [6, 6], roughness = 0.01, ndf = "triangles" }
shape = [{ type = "shell", material = "a" }]
light = [{ type = "point", position = [1.6, -3.6, 3.4], intensity = [25, 25, 25] }]
)";
  return path;
}

RenderResult render_job(const std::vector<std::string>& overrides, int rows_a_block = 0,
                        const std::string& path = rim_job()) {
  const Job job = load_job(path, overrides);
  Plan plan = make_plan(job);
  if (rows_a_block) plan.rows_a_block = rows_a_block;
  Device device(0);
  return render(job, plan, device, [](int, int) {});
}

TEST(Refinement, KeepsThePicturesTolerance) {
  const Image fine = render_job({"image.width=640", "image.height=512", "image.subpixels=1"}).image;
  double before = 0;
  for (const double tolerance : {0.3, 0.01}) {
    const RenderResult result = render_job({"accuracy.tolerance=" + std::to_string(tolerance)});
    const double off = error(result.image, fine);
    std::printf("tolerance %.3g: relative L2 %.4f, %zu pixels refined\n", tolerance, off,
                result.refined_pixels);
    EXPECT_LT(off, tolerance);
    before = tolerance > 0.05 ? off : before;
  }
  EXPECT_GT(before, 0.012) << "a scene that needs none";
}

/// Of the whole shell a picture sixteen times as fine is itself off by 2%, by what it shows of the lip.
TEST(Refinement, KeepsTheToleranceOfALip) {
  constexpr int kSide = 64;
  const Image fine = render_job({"image.width=" + std::to_string(16 * kSide),
                                 "image.height=" + std::to_string(14 * kSide), "image.subpixels=1"},
                                0, lip_job())
                         .image;
  const RenderResult result = render_job({}, 0, lip_job());
  const double off = error(result.image, fine, kSide);
  std::printf("relative L2 %.4f, %zu pixels refined\n", off, result.refined_pixels);
  EXPECT_LT(off, 0.01);
}

TEST(Refinement, DoesNotDependOnBlocks) {
  const RenderResult whole = render_job({}, 32);
  EXPECT_GT(whole.refined_pixels, 10U);
  for (const int rows : {1, 7}) {
    const RenderResult other = render_job({}, rows);
    EXPECT_EQ(other.image.pixels, whole.image.pixels) << rows;
    EXPECT_EQ(other.refined_pixels, whole.refined_pixels) << rows;
  }
}

/// A part of the rows has the pixels of the whole.
TEST(Refinement, DoesNotDependOnOtherRows) {
  const Job job = load_job(rim_job(), {});
  const Plan plan = make_plan(job);
  Device device(0);
  BuiltJob built(job, plan, device);
  const auto rows = [&](int first, int count) {
    return render_frame(
               built, job.frames.first, device.info(), [](int, int) {}, RowRange{first, count})
        .image.pixels;
  };
  std::vector<float> joined = rows(0, 9);
  const std::vector<float> rest = rows(9, 23);
  joined.insert(joined.end(), rest.begin(), rest.end());
  EXPECT_EQ(joined, rows(0, 32));
}

TEST(Refinement, LeavesPicturesOfSubpixelsAlone) {
  EXPECT_EQ(render_job({"image.filter=subpixels"}).refined_pixels, 0U);
}

}  // namespace
}  // namespace mica::host::refinement_test
