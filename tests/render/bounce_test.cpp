// What a second surface throws back: the same light that the eye would see of it, less what glints are told
// by.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "host/job/job.h"
#include "host/render/render.h"
#include "tests/temporary_path.h"

namespace mica::host::bounce_test {
namespace {

/// A plane of material m around the origin in the light of a sun, from 45 degrees: by the eye, or in a mirror
/// that hangs above, which shows the same directions.
Color seen(const std::string& material, bool in_mirror, const std::string& sun) {
  const std::string path = temporary_path("bounce_test.toml");
  std::ofstream file(path);
  file << "[image]\nwidth = 12\nheight = 12\nsubpixels = 2\nsamples = 128\n"
       << (in_mirror ? "max_bounces = 2\n" : "") << "[camera]\nfov = 0.05\nposition = [0, -3, "
       << (in_mirror ? "2]\nlook_at = [0, 0, 5]\n" : "3]\n")
       << "[[light]]\ntype = \"directional\"\ndirection = " << sun << '\n'
       << "[surface.flat]\ngenerate = \"spectrum\"\nresolution = 16\nrms_slope = 0\n"
       << "[surface.brushed]\ngenerate = \"brushed\"\nresolution = 64\nrms_slope = 0.2\n"
       << "correlation_along = 16\n"
       << "[material.m]\n"
       << material << "\n[[shape]]\ntype = \"plane\"\nmaterial = \"m\"\nsize = 1\n";
  if (in_mirror)
    file << "[material.mirror]\nsurface = \"flat\"\nroughness = 1e-3\n"
         << "[[shape]]\ntype = \"plane\"\nmaterial = \"mirror\"\nsize = 0.5\ncenter = [0, -2.5, 2.5]\n";
  file.close();
  const Job job = load_job(path, {});
  const Plan plan = make_plan(job);
  Device device(0);
  const Image image = render(job, plan, device, [](int, int) {}).image;
  Color sum = Color::Zero();
  for (std::size_t n = 0; n < image.pixels.size(); ++n) sum[n % 3] += image.pixels[n];
  return sum / (image.pixels.size() / 3.0);
}

void expect_the_mirror_shows(const std::string& material, double tolerance) {
  for (const char* sun : {"[-0.1, -1, -1]", "[0.3, -0.8, -1]"}) {
    const Color eye = seen(material, false, sun), mirror = seen(material, true, sun);
    ASSERT_GT(eye.maxCoeff(), 1e-3);
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(mirror[channel], eye[channel], tolerance * eye.maxCoeff())
          << material << " in the light along " << sun << ", channel " << channel;
  }
}

// So many glints that none is told from another. What the mirror's cosine draws miss is 1%.
const std::string kGlitter = "ndf = \"grid\"\ndensity = 1e12\nmicroroughness = 0.005\n";

TEST(Bounce, KeepsTheKindOfGlintsAndTheirDirection) {
  for (const char* distribution : {"ggx", "beckmann"})
    expect_the_mirror_shows(kGlitter + "alpha = [0.6, 0.15]\ndistribution = \"" + distribution + "\"\n",
                            0.02);
}

TEST(Bounce, KeepsTheColorsOfGlints) {
  expect_the_mirror_shows(kGlitter + "colors = [[1, 0, 0], [0.6, 0.2, 0]]\n", 0.02);
}

// The slopes of a small map are not quite a Gaussian; a round lobe is off by 80% in one of the lights.
TEST(Bounce, KeepsTheDirectionOfABrushedMap) {
  expect_the_mirror_shows("surface = \"brushed\"\nrepeat = [40000, 40000]\nroughness = 0.1\n", 0.12);
}

}  // namespace
}  // namespace mica::host::bounce_test
