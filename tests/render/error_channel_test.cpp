// The channel error.Y of a job with `auto`, against what `triangles` make of the same job.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "host/job/job.h"
#include "host/render/render.h"
#include "mica/error.h"
#include "tests/temporary_path.h"

namespace mica::host::error_channel_test {
namespace {

std::string plane_job() {
  const std::string path = temporary_path("error_channel_test.toml");
  std::ofstream(path) << R"(
[image]
width = 40
height = 24
subpixels = 2
aovs = ["ndf", "error"]
[camera]
position = [0.0, -4.0, 2.0]
look_at = [0.0, 0.0, 0.0]
fov = 30
[surface.noise]
generate = "spectrum"
resolution = 256
rms_slope = 0.15
correlation = 8
[material.metal]
surface = "noise"
repeat = [30, 30]
roughness = 0.02
ndf = "auto"
[[shape]]
type = "plane"
material = "metal"
[[light]]
type = "point"
position = [0.0, 4.0, 2.0]
intensity = [60.0, 60.0, 60.0]
)";
  return path;
}

Image render_job(const std::string& ndf) {
  const Job job = load_job(plane_job(), {"material.metal.ndf=\"" + ndf + "\""});
  Device device(0);
  return render(job, make_plan(job), device, [](int, int) {}).image;
}

double squares(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return sum;
}

TEST(ErrorChannel, IsNoSmallerThanTheErrorNorManyTimesIt) {
  const Image chosen = render_job("auto"), exact = render_job("triangles");
  ASSERT_EQ(chosen.channels, (std::vector<std::string>{"R", "G", "B", "ndf.Y", "error.Y"}));
  std::vector<double> differences, estimates, densities;
  for (std::size_t pixel = 0; pixel < chosen.pixels.size(); pixel += 5) {
    const double density = chosen.pixels[pixel + 3], estimate = chosen.pixels[pixel + 4];
    ASSERT_TRUE(std::isfinite(estimate));
    EXPECT_EQ(estimate > 0, density > 0);
    EXPECT_NEAR(exact.pixels[pixel + 4], 1e-4 * exact.pixels[pixel + 3], 1e-6 * exact.pixels[pixel + 3]);
    differences.push_back(density - exact.pixels[pixel + 3]);
    estimates.push_back(estimate);
    densities.push_back(density);
  }
  std::printf("errors %.3g, estimates %.3g, of %.3g\n", std::sqrt(squares(differences)),
              std::sqrt(squares(estimates)), std::sqrt(squares(densities)));
  EXPECT_GT(squares(differences), 0);
  EXPECT_LE(squares(differences), squares(estimates));
  // Of the queries that were looked at they are the tolerance at most; these are others.
  EXPECT_LE(squares(estimates), 1.1 * 1e-4 * squares(densities));
}

TEST(ErrorChannel, IsRefusedWhereNothingIsKnownOfTheError) {
  try {
    make_plan(load_job(plane_job(), {"material.metal.ndf=\"gaussians\""}));
    FAIL() << "no error";
  } catch (const UsageError& error) {
    EXPECT_STREQ(
        error.what(),
        "image.aovs: \"error\" wants materials with ndf \"triangles\" or \"auto\"; material metal has "
        "\"gaussians\"");
  }
}

}  // namespace
}  // namespace mica::host::error_channel_test
