// A disk lamp behind a ball: how much of it is seen changes over many pixels, or within one.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "host/job/job.h"
#include "host/render/render.h"
#include "tests/render/fine_picture.h"
#include "tests/temporary_path.h"

namespace mica::host::penumbra_test {
namespace {

Image render_job(const std::vector<std::string>& overrides, int rows_a_block = 0) {
  const std::string path = temporary_path("penumbra_test.toml");
  std::ofstream(path) << R"(
image = { width = 20, height = 20, subpixels = 4, filter = "gaussian", aovs = ["queries"] }
camera = { position = [0, -6, 3], look_at = [0, 0, 0], fov = 8 }
surface.m = { generate = "spectrum", resolution = 128, rms_slope = 0.2, correlation = 8, seed = 2 }
material.a = { surface = "m", roughness = 0.1, ndf = "triangles" }
shape = [{ type = "plane", material = "a" }, { type = "sphere", center = [0.2, -0.1, 2], radius = 0.35, material = "a" }]
light = [{ type = "disk", position = [0, 0, 4], radius = 0.5, intensity = [9, 9, 9] }]
audit = { samples = 0 }
)";
  const Job job = load_job(path, overrides);
  Plan plan = make_plan(job);
  if (rows_a_block) plan.rows_a_block = rows_a_block;
  Device device(0);
  return render(job, plan, device, [](int, int) {}).image;
}

TEST(Penumbra, IsFittedWhereItIsWide) {
  const Image one = render_job({}),
              fine = render_job({"image.width=320", "image.height=320", "image.filter=subpixels"});
  const double by_one = error(one, fine), by_sixteen = error(render_job({"image.filter=subpixels"}), fine);
  std::printf("one footprint: %.3f, sixteen: %.3f\n", by_one, by_sixteen);
  EXPECT_LT(mean_of(one, 3), 1.5);  // queries
  EXPECT_LT(by_one, 0.06);
  EXPECT_GT(by_sixteen, 2 * by_one);
}

TEST(Penumbra, IsTheSameForAnyBlockSize) {
  const Image whole = render_job({}, 20);
  for (const int rows : {1, 7}) EXPECT_EQ(render_job({}, rows).pixels, whole.pixels) << rows;
}

}  // namespace
}  // namespace mica::host::penumbra_test
