// By how much P-NDFs are off for the steps of files, as the map itself says, against the exact map that the
// file was written from; by exact triangles.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/device/device.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/surface/interpolate.h"
#include "host/surface/map_file.h"
#include "host/surface/map_precision.h"
#include "host/surface/surface.h"
#include "host/surface/texel_footprint.h"

namespace mica::host::file_steps_test {
namespace {

enum class Format { png16, half_exr };

/// The surface as it comes back from a file.
Surface through_file(const Surface& exact, Format format) {
  const bool is_png = format == Format::png16;
  const std::string path = testing::TempDir() + (is_png ? "steps.png" : "steps.exr");
  std::vector<float> floats;
  std::vector<std::uint16_t> integers;
  for (int j = exact.height() - 1; j >= 0; --j)
    for (int i = 0; i < exact.width(); ++i) {
      const Eigen::Vector2d& s = exact.texel(i, j);
      for (const double n : {s.x(), s.y(), std::sqrt(1 - s.squaredNorm())}) {
        floats.push_back(static_cast<float>(n));
        integers.push_back(static_cast<std::uint16_t>(std::lround(0.5 * (n + 1) * 65535)));
      }
    }
  OIIO::ImageSpec spec(exact.width(), exact.height(), 3,
                       is_png ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::HALF);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path);
  EXPECT_TRUE(output && output->open(path, spec));
  EXPECT_TRUE(is_png ? output->write_image(OIIO::TypeDesc::UINT16, integers.data())
                     : output->write_image(OIIO::TypeDesc::FLOAT, floats.data()));
  output->close();
  MapFile file;
  file.path = path;
  SurfaceReport report;
  return load_map(file, exact.interpolation(), report);
}

/// Relative L2 under footprints of 24 texels, by half vectors drawn from the mean of both P-NDFs.
double error_of(const Surface& rounded, const Surface& exact, double roughness) {
  constexpr int footprints = 8, each = 400;
  constexpr double sigma = 24;
  Device device(0);
  std::vector<Query> queries;
  for (int n = 0; n < footprints * each; ++n) {
    const auto normal = [n](int stream) -> Eigen::Vector2d {  // [Box and Muller 1958]
      const double radius = std::sqrt(-2 * std::log1p(-random_unit(78, stream, n))),
                   angle = 2 * kPi * random_unit(78, stream + 1, n);
      return {radius * std::cos(angle), radius * std::sin(angle)};
    };
    Query query;
    const Eigen::Vector2d middle(random_unit(77, 0, n / each), random_unit(77, 1, n / each));
    query.footprint = make_footprint(exact, middle, sigma, sigma, 0);
    query.roughness = roughness;
    const Eigen::Vector2d place = middle * exact.width() + sigma * normal(0);
    query.half_vector = normal_at(n % 2 == 0 ? exact : rounded, place) + roughness * normal(2);
    queries.push_back(query);
  }
  const std::vector<float> found = TriangleEvaluator(device, rounded).evaluate(queries),
                           expected = TriangleEvaluator(device, exact).evaluate(queries);
  double difference = 0, square = 0;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const double a = found[n], b = expected[n], mean = 0.5 * (a + b);
    if (mean > 0) difference += (a - b) * (a - b) / mean, square += b * b / mean;
  }
  return std::sqrt(difference / square);
}

Surface surface_of(const decltype(SurfaceDescription::source)& source,
                   Interpolation interpolation = Interpolation::bilinear) {
  return make_surface({"exact", source, interpolation}, nullptr);
}

/// Within a factor of 1.5, of which the measure may take another tenth.
void expect_said(const Surface& exact, Format format, double roughness) {
  const Surface rounded = through_file(exact, format);
  const double error = error_of(rounded, exact, roughness), said = precision_error(rounded, roughness);
  std::printf("roughness %g: %.3f%%, said %.3f%%\n", roughness, 100 * error, 100 * said);
  EXPECT_LE(said, 1.65 * error);
  EXPECT_GE(said, error / 1.65);
}

TEST(FileSteps, AreSaidOfSixteenBits) {
  expect_said(surface_of(SpectrumSurface{256, 0.2, 20, 61}), Format::png16, 1e-4);
  expect_said(surface_of(FlakesSurface{256, 10, 0.3, 62}, Interpolation::nearest), Format::png16, 1e-4);
}

/// Their steps differ from number to number, and that of the third coordinate is the widest.
TEST(FileSteps, AreSaidOfHalfFloats) {
  expect_said(surface_of(SpectrumSurface{256, 0.2, 20, 63}), Format::half_exr, 2e-4);
  expect_said(surface_of(FlakesSurface{256, 10, 0.3, 64}, Interpolation::nearest), Format::half_exr, 5e-4);
}

}  // namespace
}  // namespace mica::host::file_steps_test
