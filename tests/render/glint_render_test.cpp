// Pictures of glints without a map: they add up to the smooth distribution however they are mapped and
// whatever varies them, keep the error that they promise, and are the same for any block size.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "host/image/image.h"
#include "host/job/job.h"
#include "host/render/render.h"
#include "mica/error.h"
#include "tests/temporary_path.h"

namespace mica::host::glint_render_test {
namespace {

const char* const kSun = "type = \"directional\"\ndirection = [0.3, 1.0, -0.8]";
const char* const kFurnace = "type = \"furnace\"";

/// A small picture of a sphere; `keys` go into its material.
std::string sphere_job(const std::string& keys, const std::string& light = kSun) {
  const std::string path = temporary_path("glint_render_test.toml");
  std::ofstream(path) << R"(
[image]
width = 96
height = 72
subpixels = 2
filter = "subpixels"
aovs = ["ndf"]
[camera]
position = [0.0, -4.0, 1.0]
look_at = [0.0, 0.0, 0.0]
fov = 32
[[shape]]
type = "sphere"
material = "glitter"
[audit]
samples = 200
[material.glitter]
ndf = "grid"
alpha = 0.5
)" << keys << "\n[[light]]\n"
                      << light << '\n';
  return path;
}

RenderResult render_sphere(const std::string& keys, int rows_a_block = 0, const std::string& light = kSun,
                           const std::vector<std::string>& overrides = {}) {
  const Job job = load_job(sphere_job("microroughness = 0.05\n" + keys, light), overrides);
  Plan plan = make_plan(job);
  if (rows_a_block) plan.rows_a_block = rows_a_block;
  Device device(0);
  return render(job, plan, device, [](int, int) {});
}

/// Sum of a channel over the picture.
double total(const RenderResult& result, std::size_t channel) {
  double sum = 0;
  for (std::size_t n = channel; n < result.image.pixels.size(); n += result.image.channels.size())
    sum += result.image.pixels[n];
  return sum;
}

/// A grey ramp over u, from black to white.
std::string ramp() {
  const std::string path = temporary_path("glint_ramp.exr");
  Image image;
  image.width = 64, image.height = 2, image.channels = {"R", "G", "B"};
  for (int n = 0; n < 128; ++n) image.pixels.insert(image.pixels.end(), 3, static_cast<float>(n % 64) / 63);
  write_exr(path, image);
  return path;
}

/// A picture of one colour.
std::string constant(float r, float g, float b) {
  const std::string path = temporary_path("glint_color.exr");
  Image image;
  image.width = 1, image.height = 1, image.channels = {"R", "G", "B"}, image.pixels = {r, g, b};
  write_exr(path, image);
  return path;
}

const std::vector<std::string>& variants() {
  static const std::vector<std::string> keys = {"",
                                                "distribution = \"beckmann\"",
                                                "mapping = \"triplanar\"\ndensity = 1e5",
                                                "stretch = 4",
                                                "masking = \"cavity\"",
                                                "colors = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
                                                "textures = { density = \"" + ramp() + "\" }",
                                                "stretch = 8\ntextures = { stretch = \"" + ramp() + "\" }",
                                                "textures = { alpha = \"" + ramp() + "\" }",
                                                "textures = { microroughness = \"" + ramp() + "\" }"};
  return keys;
}

TEST(GlintRender, KeepsItsErrorInAllItsForms) {
  for (const std::string& keys : variants()) {
    const RenderResult result = render_sphere(keys);
    EXPECT_EQ(result.audit.samples, 200u) << keys;
    EXPECT_LT(result.audit.maximum, 1e-4) << keys;
    EXPECT_GT(total(result, 0), 0) << keys;
    EXPECT_EQ(result.device_bytes, 0u) << keys;
    for (const float value : result.image.pixels) ASSERT_TRUE(std::isfinite(value) && value >= 0) << keys;
  }
}

TEST(GlintRender, AddsUpToTheSmoothDistribution) {
  const double smooth = total(render_sphere("density = 1e12"), 0);
  EXPECT_NEAR(total(render_sphere(""), 0), smooth, 0.02 * smooth);
  for (const char* keys : {"mapping = \"triplanar\"", "textures = { density = \"RAMP\" }",
                           "stretch = 8\ntextures = { stretch = \"RAMP\" }"}) {
    std::string with_file = keys;
    const std::size_t place = with_file.find("RAMP");
    if (place != std::string::npos) with_file.replace(place, 4, ramp());
    EXPECT_NEAR(total(render_sphere(with_file), 0), smooth, 0.02 * smooth) << keys;
  }
}

TEST(GlintRender, ColorsAverageToTheirMean) {
  const RenderResult white = render_sphere("density = 1e8");
  const RenderResult colored =
      render_sphere("density = 1e8\ncolors = [[1, 0, 0], [1, 0.5, 0], [0.4, 0.4, 0.4], [0, 0.3, 0]]");
  const double expected[] = {0.6, 0.3, 0.1};
  for (std::size_t channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(total(colored, channel), expected[channel] * total(white, channel),
                0.03 * expected[channel] * total(white, channel));
  EXPECT_NE(colored.image.pixels, white.image.pixels);
}

TEST(GlintRender, IsTheSameForAnyBlockSize) {
  const std::string keys = "mapping = \"triplanar\"\ncolors = [[1, 0, 0], [0, 1, 1]]";
  EXPECT_EQ(render_sphere(keys, 72).image.pixels, render_sphere(keys, 5).image.pixels);
}

TEST(GlintRender, ShinesInLightFromAllAround) {
  const double black =
      total(render_sphere("colors = [[0, 0, 0]]", 0, kFurnace), 0);  // what is around the sphere
  const double smooth = total(render_sphere("density = 1e12", 0, kFurnace), 0) - black,
               glints = total(render_sphere("density = 1e5", 0, kFurnace), 0) - black;
  EXPECT_NEAR(glints, smooth, 0.02 * smooth);
  const RenderResult colored = render_sphere("density = 1e5\ncolors = [[1, 0, 0], [1, 0.5, 0]]", 0, kFurnace);
  const double expected[] = {1, 0.25, 0};  // chance gives glints more or less of the second colour
  for (std::size_t channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(total(colored, channel) - black, expected[channel] * glints,
                (channel == 1 ? 0.03 : 1e-4) * glints);
}

/// A smaller one in a furnace.
RenderResult render_in_furnace(const std::string& keys) {
  return render_sphere(keys, 0, kFurnace, {"image.width=32", "image.height=24", "image.subpixels=1"});
}

TEST(GlintRender, ShinesInLightFromAllAroundInAllItsForms) {
  const double black = total(render_in_furnace("colors = [[0, 0, 0]]"), 0);
  const double smooth = total(render_in_furnace("density = 1e12"), 0) - black;
  for (const std::string& keys :
       {std::string("mapping = \"triplanar\""), "textures = { density = \"" + ramp() + "\" }",
        "stretch = 8\ntextures = { stretch = \"" + ramp() + "\" }"})
    EXPECT_NEAR(total(render_in_furnace(keys), 0) - black, smooth, 0.03 * smooth) << keys;
  const RenderResult red = render_in_furnace("textures = { color = \"" + constant(1, 0.25F, 0) + "\" }");
  const double expected[] = {1, 0.25, 0};
  for (std::size_t channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(total(red, channel) - black, expected[channel] * smooth, 0.03 * smooth);
}

TEST(GlintRender, RedAndBlueAreNotPurpleInLightFromAllAround) {
  const RenderResult result = render_in_furnace("density = 100\ncolors = [[1, 0, 0], [0, 0, 1]]");
  double difference = 0, sum = 0;
  const std::vector<float>& pixels = result.image.pixels;
  for (std::size_t n = 0; n < pixels.size(); n += result.image.channels.size()) {
    if (pixels[n + 1] > 0) continue;  // sees past the sphere
    difference += std::abs(pixels[n] - pixels[n + 2]), sum += pixels[n] + pixels[n + 2];
  }
  EXPECT_GT(difference, 0.2 * sum);
}

TEST(GlintRender, PlansNothingButAKernel) {
  const Job job = load_job(sphere_job("[surface.unused]\ngenerate = \"flakes\"\n"), {});
  const Plan plan = make_plan(job);
  ASSERT_EQ(plan.evaluators.size(), 1u);
  EXPECT_EQ(plan.evaluators[0].surface_index, -1);
  EXPECT_EQ(plan.evaluators[0].device_bytes + plan.evaluators[0].host_bytes, 0u);
}

}  // namespace
}  // namespace mica::host::glint_render_test
