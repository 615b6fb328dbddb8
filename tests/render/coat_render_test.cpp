// Pictures of coats: one that is hardly there changes no method's picture.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <utility>

#include "host/render/render.h"
#include "tests/temporary_path.h"

namespace mica::host::coat_render_test {
namespace {

/// Mean radiance of a rough golden ball: over all normals. At one alone refraction stretches lobes, which the
/// thinnest coat does by 2 % of their height.
double mean_of(const std::string& material, const std::string& light) {
  const std::string path = temporary_path("coat_render_test.toml");
  std::ofstream(path)
      << R"(
image = { width = 24, height = 24, subpixels = 2, samples = 64 }
camera = { position = [0, -4, 0], fov = 32 }
surface.m = { generate = "spectrum", resolution = 64, rms_slope = 0.25, correlation = 8 }
shape = [{ type = "sphere", material = "a" }]
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

/// A material, and by how much the thinnest coat may change its picture.
using Covered = std::pair<std::string, double>;
class ThinCoat : public testing::TestWithParam<Covered> {};

TEST_P(ThinCoat, CannotBeSeen) {
  const auto& [material, allowed] = GetParam();
  for (const std::string light :
       {"type = \"directional\", direction = [0.5, 1, -0.4]", "type = \"furnace\""}) {
    const double bare = mean_of(material, light);
    const double coated = mean_of(material + "coat = { ior = 1.01, roughness = 0.1 }\n", light);
    std::printf("%+.2f%%, %s", 100 * (coated / bare - 1), material.c_str());
    EXPECT_NEAR(coated / bare, 1, allowed) << material << light;
  }
}

Covered on_map(const std::string& keys, double allowed = 0.01) {
  return {"surface = \"m\"\nroughness = 0.1\n" + keys + "\n", allowed};
}

/// Light between base and coat is that of a Beckmann lobe: of one normal, and of GGX, which sends more of it
/// beyond the critical angle, some is lost.
constexpr double kOtherLobe = 0.02;

INSTANTIATE_TEST_SUITE_P(
    Methods, ThinCoat,
    testing::Values(on_map("ndf = \"triangles\"\ndiffuse = [0.1, 0.3, 0.5]"), on_map("ndf = \"gaussians\""),
                    on_map("ndf = \"smooth\""), on_map("ndf = \"pyramid\""), on_map("ndf = \"auto\""),
                    on_map("ndf = \"beckmanns\""), on_map("ndf = \"beckmanns\"\nmasking = \"filtered\""),
                    on_map("ndf = \"beckmanns\"\nmasking = \"geometric\""), on_map("ndf = \"cavities\""),
                    on_map("ndf = \"cavities\"\nenergy = \"sampled\"\ncompensation = \"specular\""),
                    on_map("ndf = \"normalmap\"", kOtherLobe),
                    Covered("ndf = \"grid\"\nalpha = [0.3, 0.5]\nmicroroughness = 0.1\ndensity = 1e5\n",
                            kOtherLobe),
                    Covered("ndf = \"grid\"\nalpha = 0.4\nmicroroughness = 0.1\ndensity = 1e5\n"
                            "masking = \"cavity\"\ndistribution = \"beckmann\"\n",
                            0.01)));

}  // namespace
}  // namespace mica::host::coat_render_test
