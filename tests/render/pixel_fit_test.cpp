// Pictures with few footprints a pixel against one sixteen times as fine that is convolved with the same
// filter: there a footprint is a sixteenth as wide, and neither bends nor turns by much.
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "host/job/job.h"
#include "host/render/render.h"
#include "tests/render/fine_picture.h"
#include "tests/temporary_path.h"

namespace mica::host::pixel_fit_test {
namespace {

constexpr int kSize = 40;  // pixels a side

std::string sphere_job() {
  const std::string path = temporary_path("pixel_fit_test.toml");
  std::ofstream(path) << R"(
image = { width = 40, height = 40, subpixels = 4, filter = "gaussian", aovs = ["queries"] }
camera = { position = [0, -8, 0], look_at = [-0.1, 0, 0.15], fov = 4.5 }
surface.m = { generate = "spectrum", resolution = 256, rms_slope = 0.3, correlation = 8, seed = 2 }
material.a = { surface = "m", repeat = [12, 6], roughness = 0.01, ndf = "triangles" }
shape = [{ type = "sphere", material = "a" }]
light = [{ type = "directional", direction = [-0.2, 1, -0.3], irradiance = [3, 3, 3] }]
)";
  return path;
}

RenderResult render_job(const std::vector<std::string>& overrides, int rows_a_block = 0) {
  const Job job = load_job(sphere_job(), overrides);
  Plan plan = make_plan(job);
  if (rows_a_block) plan.rows_a_block = rows_a_block;
  Device device(0);
  return render(job, plan, device, [](int, int) {});
}

const Image& fine_picture() {
  static const Image fine = render_job({"image.width=640", "image.height=640", "image.subpixels=1"}).image;
  return fine;
}

TEST(PixelFit, OneFootprintAPixelShowsAsMuchAsTheFinePicture) {
  const RenderResult one = render_job({});
  EXPECT_LT(mean_of(one.image, 3), 1.5);  // queries
  EXPECT_LT(error(one.image, fine_picture()), 0.005);
  // With constant half vectors sixteen footprints a pixel are further away.
  const RenderResult sixteen = render_job({"image.filter=subpixels"});
  EXPECT_GT(error(sixteen.image, fine_picture()), 0.01);
}

/// Towards the rim uv bend: footprints are split until they leave out what the tolerance allows.
TEST(PixelFit, SplitsFootprintsThatBend) {
  const std::vector<std::string> rim = {
      "camera.look_at=[0.75, -0.66, 0.1]", "camera.fov=3",
      "light=[{ type = \"directional\", direction = [-0.99, -0.13, -0.1], irradiance = [3, 3, 3] }]"};
  const auto render_rim = [&](std::vector<std::string> overrides) {
    overrides.insert(overrides.end(), rim.begin(), rim.end());
    return render_job(overrides).image;
  };
  const Image fine = render_rim({"image.width=640", "image.height=640", "image.subpixels=1"});
  const Image one = render_rim({"accuracy.tolerance=0.5"}), split = render_rim({"accuracy.tolerance=0.001"});
  EXPECT_LT(mean_of(one, 3), 2);  // queries
  EXPECT_GT(mean_of(split, 3), 2);
  EXPECT_LT(error(split, fine), 0.6 * error(one, fine));
}

/// Of a whole small ball; half vectors that were carried on linearly over its rim made it glow.
TEST(PixelFit, ABallIsAsBrightAsByManySamples) {
  const std::vector<std::string> ball = {
      "camera.position=[0, -4, 0]",
      "camera.look_at=[0, 0, 0]",
      "camera.fov=32",
      "material.a.roughness=0.1",
      "material.a.ndf=smooth",
      "image.width=24",
      "image.height=24",
      "light=[{ type = \"directional\", direction = [0.5, 1, -0.4], irradiance = [3, 3, 3] }]"};
  const auto brightness = [&](std::vector<std::string> overrides) {
    overrides.insert(overrides.end(), ball.begin(), ball.end());
    const Image image = render_job(overrides).image;
    double sum = 0;
    for (int row = 0; row < image.height; ++row)
      for (int column = 0; column < image.width; ++column) sum += green(image, row, column);
    return sum;
  };
  const double many = brightness({"image.filter=subpixels", "image.subpixels=16"});
  for (const char* subpixels : {"image.subpixels=2", "image.subpixels=4"})
    EXPECT_NEAR(brightness({subpixels}), many, 0.03 * many) << subpixels;
}

TEST(PixelFit, IsTheSameForAnyBlockSize) {
  const RenderResult whole = render_job({}, kSize);
  for (const int rows : {1, 7}) EXPECT_EQ(render_job({}, rows).image.pixels, whole.image.pixels) << rows;
}

/// Where pictures are good and where they are bad: by a coarse mixture, and by a smooth lobe without glints.
TEST(PictureAudit, TellsTheErrorOfThePicture) {
  for (const std::vector<std::string>& job : std::vector<std::vector<std::string>>{
           {}, {"material.a.ndf=gaussians", "material.a.elements=1"}, {"material.a.ndf=smooth"}}) {
    std::vector<std::string> overrides = job;
    overrides.insert(overrides.end(), {"audit.samples=1", "audit.pixels=300"});
    const RenderResult audited = render_job(overrides);
    const PictureAudit& audit = audited.picture_audit;
    const double truth = error(audited.image, fine_picture());
    std::printf("relative L2 %.4f: audit %.4f, at most %.4f; %d subpixels, %.5f\n", truth, audit.relative_l2,
                audit.upper_bound, audit.subpixels, audit.reference_l2);
    EXPECT_EQ(audit.pixels, 300);
    EXPECT_NEAR(audit.relative_l2, truth, 0.2 * truth);
    EXPECT_GE(audit.upper_bound, audit.relative_l2);
    EXPECT_LE(audit.reference_l2, 0.001);
    EXPECT_NE(audited.image.metadata.at("mica:audit.picture").find("300 pixels"), std::string::npos);
  }
}

/// One footprint with a constant half vector is further from its own filter than sixteen.
TEST(PictureAudit, CountsWhatConstantHalfVectorsLose) {
  const auto audit_of = [](const std::string& subpixels) {
    return render_job({"image.filter=subpixels", "image.subpixels=" + subpixels, "audit.samples=1",
                       "audit.pixels=40"})
        .picture_audit;
  };
  const PictureAudit one = audit_of("1"), four = audit_of("4");
  EXPECT_EQ(one.pixels, 40);
  EXPECT_GT(one.relative_l2, 0.05);
  EXPECT_LT(four.relative_l2, 0.25 * one.relative_l2);
}

}  // namespace
}  // namespace mica::host::pixel_fit_test
