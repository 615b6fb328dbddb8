// Images of P-NDFs, drawn element by element, against the oracle and against the same numbers query by query.
#include <gtest/gtest.h>

#include <cmath>

#include "host/base/error_norms.h"
#include "host/methods/pyramid/pyramid_painter.h"
#include "host/reference/oracle.h"
#include "host/surface/texel_footprint.h"
#include "tests/methods/bilinear_samples.h"

namespace mica::host::pyramid_images_test {
namespace {

using Way = PyramidPainter::Way;

Device& device() {
  static Device shared(0);  // programs are built once for all tests
  return shared;
}

Surface spectrum() {
  return make_surface({"test", SpectrumSurface{256, 0.15, 8, 3}, Interpolation::bilinear}, nullptr);
}
Surface flakes() {
  return make_surface({"test", FlakesSurface{256, 12, 0.2, 5}, Interpolation::nearest}, nullptr);
}

Query footprint(const Surface& surface, double u, double v, double major, double minor, double roughness) {
  return {make_footprint(surface, {u, v}, major, minor, 0.4), {0, 0}, roughness};
}

/// One percent of the oracle, over the pixels on the disk; the others are 0.
void expect_image(const Surface& surface, const Query& query, const ImageWindow& window, Way way,
                  const PyramidSettings& settings = {}) {
  PyramidEvaluator pyramid(device(), surface, settings);
  PyramidPainter painter(device(), surface, pyramid);
  EXPECT_EQ(painter.way(query), way);
  const std::vector<float> image = painter.paint({query}, window);
  std::vector<Query> queries;
  std::vector<float> drawn;
  for (std::size_t pixel = 0; pixel < window.count(); ++pixel) {
    const Eigen::Vector2d half_vector = window.half_vector(pixel);
    if (half_vector.squaredNorm() >= 1) {
      EXPECT_EQ(image[pixel], 0) << pixel;
      continue;
    }
    queries.push_back({query.footprint, half_vector, query.roughness});
    drawn.push_back(image[pixel]);
  }
  std::vector<double> expected;
  for (const reference::OracleResult& result : reference::Oracle(surface, 1e-4).evaluate(queries))
    expected.push_back(result.density);
  const double error = relative_l2(drawn, expected);
  std::printf("roughness %g: %.3f%%\n", query.roughness, 100 * error);
  EXPECT_LE(error, 0.01);
}

TEST(PyramidImages, KeepOnePercentWhereTheyAreDrawnFromALevel) {
  expect_image(spectrum(), footprint(spectrum(), 0.9, 0.2, 32, 20, 0.03), {{0, 0}, 1, 30}, Way::level);
  expect_image(flakes(), footprint(flakes(), 0.1, 0.7, 16, 16, 0.02), {{0, 0}, 1, 33}, Way::level);
}
TEST(PyramidImages, KeepOnePercentWhereTheyAreDrawnFromACompactLevel) {
  PyramidSettings settings;
  settings.levels_bytes = 400'000;
  const Surface surface = spectrum();
  const Query query = footprint(surface, 0.9, 0.2, 64, 50, 0.02);
  PyramidEvaluator pyramid(device(), surface, settings);
  EXPECT_EQ(pyramid.level(*pyramid.choose(query)).shape().record_bits, 8);
  expect_image(surface, query, {{0, 0}, 1, 30}, Way::level, settings);
}
TEST(PyramidImages, KeepOnePercentWhereTheyAreDrawnFromTexels) {
  expect_image(spectrum(), footprint(spectrum(), 0.98, 0.5, 9, 6, 0.005), {{0.1, 0}, 0.2, 31}, Way::texels);
  expect_image(flakes(), footprint(flakes(), 0.1, 0.7, 3, 3, 0.02), {{0, 0}, 1, 29}, Way::texels);
}
/// The rim of the disk, where pixels without a half vector begin.
TEST(PyramidImages, KeepOnePercentWhereTheyAreDrawnByQueries) {
  expect_image(spectrum(), footprint(spectrum(), 0.3, 0.2, 1, 1, 0.3), {{0.9, 0.1}, 0.3, 20}, Way::queries);
}

/// One image has several bands, and as many as make a batch are drawn at once.
TEST(PyramidImages, AreTheSameInAnyBatch) {
  const Surface surface = spectrum();
  PyramidEvaluator pyramid(device(), surface);
  PyramidPainter painter(device(), surface, pyramid);
  const ImageWindow window{{0.02, -0.01}, 0.5, 70};
  std::vector<Query> footprints;
  for (int n = 0; n < 6; ++n)
    footprints.push_back(footprint(surface, 0.37 * n, 0.1 * n, n < 4 ? 24 : 5, n < 3 ? 18 : 5, 0.02));
  const std::vector<float> all = painter.paint(footprints, window);
  for (std::size_t n = 0; n < footprints.size(); ++n) {
    const std::vector<float> one = painter.paint({footprints[n]}, window);
    const auto expected = all.begin() + static_cast<long>(n * window.count());
    EXPECT_TRUE(std::equal(one.begin(), one.end(), expected)) << "image " << n;
  }
}

/// A window shows what a wider one shows there, up to rounding, and up to what pixels beyond an element's
/// reach get of it for being in a square with others.
TEST(PyramidImages, OfAWindowAreThoseOfTheDisk) {
  const Surface surface = spectrum();
  PyramidEvaluator pyramid(device(), surface);
  PyramidPainter painter(device(), surface, pyramid);
  const Query query = footprint(surface, 0.3, 0.6, 24, 24, 0.02);
  const ImageWindow disk{{0, 0}, 1, 160}, window{{0.125, -0.25}, 0.25, 40};
  const std::vector<float> whole = painter.paint({query}, disk), part = painter.paint({query}, window);
  RelativeL2 error;
  for (std::size_t row = 0; row < 40; ++row) {
    for (std::size_t column = 0; column < 40; ++column)
      error.add(part[row * 40 + column], whole[(row + 80) * 160 + column + 70]);
  }
  ASSERT_TRUE(error.has_reference());
  EXPECT_LE(error.value(), 1e-3);
}

}  // namespace
}  // namespace mica::host::pyramid_images_test
