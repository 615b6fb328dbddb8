// Pictures of coats: one that is hardly there changes no method's picture.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "host/render/render.h"
#include "tests/temporary_path.h"

namespace mica::host::coat_render_test {
namespace {

/// Mean radiance of a plane of rough metal over a diffuse base, seen from 34 degrees off its normal.
double mean_of(const std::string& material, const std::string& light) {
  const std::string path = temporary_path("coat_render_test.toml");
  std::ofstream(path)
      << R"(
image = { width = 16, height = 16, subpixels = 2, samples = 64 }
camera = { position = [0, -2, 3], fov = 8 }
surface.m = { generate = "spectrum", resolution = 64, rms_slope = 0.25, correlation = 8 }
shape = [{ type = "plane", size = 10, material = "a" }]
light = [{ )"
      << light
      << " }]\n[material.a]\nrepeat = [8, 8]\nspecular = { eta = [0.2, 0.92, 1.1], k = [3.9, 2.45, 2.1] }\n"
      << material;
  const Job job = load_job(path, {});
  Device device(0);
  const Image image = render(job, make_plan(job), device, [](int, int) {}).image;
  double sum = 0;
  for (const float value : image.pixels) sum += value;
  return sum / static_cast<double>(image.pixels.size());
}

class ThinCoat : public testing::TestWithParam<std::string> {};

TEST_P(ThinCoat, CannotBeSeen) {
  for (const std::string light :
       {"type = \"directional\", direction = [0.2, 0.3, -1]", "type = \"furnace\""}) {
    const double bare = mean_of(GetParam(), light);
    const double coated = mean_of(GetParam() + "coat = { ior = 1.01, roughness = 0.1 }\n", light);
    std::printf("%.5f bare, %.5f below a coat of index 1.01: %+.2f%%\n", bare, coated,
                100 * (coated / bare - 1));
    EXPECT_NEAR(coated / bare, 1, 0.01) << light;
  }
}

std::string on_map(const std::string& keys) {
  return "surface = \"m\"\nroughness = 0.1\n" + keys + "\n";
}

INSTANTIATE_TEST_SUITE_P(
    Methods, ThinCoat,
    testing::Values(on_map("ndf = \"triangles\"\ndiffuse = [0.1, 0.3, 0.5]"), on_map("ndf = \"gaussians\""),
                    on_map("ndf = \"smooth\""), on_map("ndf = \"pyramid\""), on_map("ndf = \"auto\""),
                    on_map("ndf = \"beckmanns\""), on_map("ndf = \"beckmanns\"\nmasking = \"filtered\""),
                    on_map("ndf = \"beckmanns\"\nmasking = \"geometric\""), on_map("ndf = \"cavities\""),
                    on_map("ndf = \"cavities\"\nenergy = \"table\"\ncompensation = \"specular\""),
                    on_map("ndf = \"normalmap\""),
                    std::string("ndf = \"grid\"\nalpha = [0.3, 0.5]\nmicroroughness = 0.1\ndensity = 1e5\n"),
                    std::string("ndf = \"grid\"\nalpha = 0.4\nmicroroughness = 0.1\ndensity = 1e5\n"
                                "masking = \"cavity\"\ndistribution = \"beckmann\"\n")));

}  // namespace
}  // namespace mica::host::coat_render_test
