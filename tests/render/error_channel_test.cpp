// The channel error.Y of a job with `auto`, against what `triangles` make of the same job.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "host/job/job.h"
#include "host/render/luminance.h"
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

Image render_job(const std::string& ndf, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides = {"material.metal.ndf=\"" + ndf + "\""};
  overrides.insert(overrides.end(), more.begin(), more.end());
  const Job job = load_job(plane_job(), overrides);
  Device device(0);
  return render(job, make_plan(job), device, [](int, int) {}).image;
}

double luminance_of(const Image& image, std::size_t pixel) {
  return luminance(Eigen::Map<const Eigen::Vector3f>(&image.pixels[pixel]).cast<double>());
}

double squares(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return sum;
}

/// What the channel says, over what the picture is off by: root mean squares.
double said_to_true(const Image& shown, const Image& truth) {
  EXPECT_EQ(shown.channels, (std::vector<std::string>{"R", "G", "B", "ndf.Y", "error.Y"}));
  std::vector<double> differences, estimates, light;
  for (std::size_t pixel = 0; pixel < shown.pixels.size(); pixel += 5) {
    const double estimate = shown.pixels[pixel + 4];
    EXPECT_TRUE(std::isfinite(estimate) && estimate >= 0);
    differences.push_back(luminance_of(shown, pixel) - luminance_of(truth, pixel));
    estimates.push_back(estimate);
    light.push_back(luminance_of(truth, pixel));
  }
  std::printf("errors %.3g, estimates %.3g, of %.3g\n", std::sqrt(squares(differences)),
              std::sqrt(squares(estimates)), std::sqrt(squares(light)));
  return std::sqrt(squares(estimates) / squares(differences));
}

// Against sums of samples four times as dense along each axis: of a method that chooses, of footprints that
// turn, and of samples at the silhouettes of a sphere.
TEST(ErrorChannel, IsAsLargeAsThePicturesError) {
  for (const auto& [ndf, more] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"auto", {}},
           {"triangles", {"accuracy.tolerance=0.05", "material.metal.roughness=0.005"}},
           {"triangles", {"shape.0.type=sphere", "accuracy.tolerance=0.05"}}}) {
    SCOPED_TRACE(testing::PrintToString(more));
    std::vector<std::string> fine = more;
    fine.insert(fine.end(), {"image.subpixels=16", "accuracy.tolerance=0.0005"});
    const double ratio = said_to_true(render_job(ndf, more), render_job("triangles", fine));
    EXPECT_GT(ratio, 0.5);
    EXPECT_LT(ratio, 4);
  }
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
