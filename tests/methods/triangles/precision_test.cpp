// `triangles` asked for less precision: what a tolerance promises, on maps that its rules were not tuned on.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "host/base/constants.h"
#include "host/base/error_norms.h"
#include "host/base/random.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/methods/triangles/triangle_precision.h"
#include "host/surface/texel_footprint.h"

namespace mica::host::triangle_precision_test {
namespace {

Device& device() {
  static Device shared(0);  // programs are built once for all tests
  return shared;
}

struct Map {
  std::string name;
  decltype(SurfaceDescription::source) source;
  Interpolation interpolation = Interpolation::bilinear;
};

void PrintTo(const Map& map, std::ostream* stream) {
  *stream << map.name;
}

/// Half vectors that hit: normals under footprints of `sigma_texels`, and the lobe about them.
std::vector<Query> hitting_queries(const Surface& surface, double sigma_texels, double roughness, int count) {
  std::vector<Query> queries(static_cast<std::size_t>(count));
  for (int n = 0; n < count; ++n) {
    const auto random = [&](std::uint64_t stream) { return random_unit(21, stream, n); };
    const auto normal = [&](std::uint64_t stream) {
      return std::sqrt(-2 * std::log(1 - random(stream))) * std::cos(2 * kPi * random(stream + 1));
    };
    Query& query = queries[static_cast<std::size_t>(n)];
    const double thinness = std::pow(4, random(0));
    query.footprint = make_footprint(surface, {random(1), random(2)}, sigma_texels * std::sqrt(thinness),
                                     sigma_texels / std::sqrt(thinness), kPi * random(3));
    const Eigen::Vector2d texel(random(1) * surface.width() + sigma_texels * normal(4),
                                random(2) * surface.height() + sigma_texels * normal(6));
    query.half_vector = surface.texel(std::lround(texel.x()), std::lround(texel.y())) +
                        roughness * Eigen::Vector2d(normal(8), normal(10));
    query.roughness = roughness;
  }
  return queries;
}

/// Half vectors that turn by a lobe over a footprint's standard deviation, one way more than the other, and
/// lobes of 2 : 1.
std::vector<Query> turned(std::vector<Query> queries) {
  for (Query& query : queries) {
    const double sigma_uv = std::sqrt(query.footprint.cov_uv(0, 0));
    query.half_vector_turn << 1, 0.3, -0.2, 0.5;
    query.half_vector_turn *= query.roughness / sigma_uv;
    query.lobe_cov = query.roughness * query.roughness * Eigen::Vector2d(2, 0.5).asDiagonal().toDenseMatrix();
  }
  return queries;
}

std::vector<float> by_triangles(const Surface& surface, double tolerance, const std::vector<Query>& queries) {
  TriangleSettings settings;
  settings.tolerance = tolerance;
  return TriangleEvaluator(device(), surface, settings).evaluate(queries);
}

class TrianglePrecisionOf : public testing::TestWithParam<Map> {};

TEST_P(TrianglePrecisionOf, KeepsTheTolerance) {
  const Surface surface = make_surface({"test", GetParam().source, GetParam().interpolation}, nullptr);
  double largest = 0;
  for (const bool turns : {false, true})
    for (const double roughness : {0.003, 0.01, 0.04})
      for (const double sigma_texels : {0.7, 2.5, 11.0, 45.0}) {
        std::vector<Query> queries = hitting_queries(surface, sigma_texels, roughness,
                                                     sigma_texels > 40  ? 40
                                                     : sigma_texels > 8 ? 150
                                                                        : 600);
        if (turns) queries = turned(std::move(queries));
        const std::vector<float> exact = by_triangles(surface, kExactTriangles, queries);
        const std::vector<double> expected(exact.begin(), exact.end());
        for (const double tolerance : {1e-3, 6e-3, 1e-2, 3e-2}) {
          const std::vector<float> densities = by_triangles(surface, tolerance, queries);
          const double error = relative_l2(densities, expected) / tolerance;
          EXPECT_LE(error, 1) << "sigma " << sigma_texels << ", roughness " << roughness << ", tolerance "
                              << tolerance << (turns ? ", turned" : "");
          largest = std::max(largest, error);
          for (std::size_t n = 0; n < queries.size(); ++n) ASSERT_GE(densities[n], 0) << n;
        }
      }
  std::printf("%s: at most %.2f of the tolerance\n", GetParam().name.c_str(), largest);
  EXPECT_GT(largest, 0.05);  // else it is not less precise, nor less work
}

INSTANTIATE_TEST_SUITE_P(
    Maps, TrianglePrecisionOf,
    testing::Values(Map{"spectrum", SpectrumSurface{192, 0.25, 5, 31}},
                    Map{"spectrum_bicubic", SpectrumSurface{128, 0.25, 6, 32}, Interpolation::bicubic},
                    Map{"flakes", FlakesSurface{192, 14, 0.15, 33}},
                    Map{"flakes_nearest", FlakesSurface{192, 14, 0.15, 33}, Interpolation::nearest},
                    Map{"brushed", BrushedSurface{192, 0.2, 40, 2, 30, 34}},
                    Map{"scratches", ScratchesSurface{192, 0.5, 100, 6}}, Map{"dents", DentsSurface{192}},
                    Map{"bumps", BumpsSurface{192}}),
    [](const testing::TestParamInfo<Map>& info) { return info.param.name; });

TEST(TrianglePrecision, CutsMoreTheMoreItMay) {
  EXPECT_EQ(triangle_precision(kExactTriangles).level, 0);
  EXPECT_EQ(triangle_precision(kExactTriangles).kept, 1);
  double cutoff = triangle_precision(kExactTriangles).cutoff;
  int level = 0;
  for (const double tolerance : {2e-4, 1e-3, 5e-3, 1e-2, 3e-2}) {
    const TrianglePrecision precision = triangle_precision(tolerance);
    EXPECT_LT(precision.cutoff, cutoff) << tolerance;
    EXPECT_GE(precision.level, level) << tolerance;
    EXPECT_LT(1 - precision.kept, tolerance) << tolerance;
    cutoff = precision.cutoff, level = precision.level;
  }
  EXPECT_EQ(level, 2);
  EXPECT_EQ(triangle_precision(0.5).cutoff, cutoff);
}

/// Answers do not depend on what else is asked.
TEST(TrianglePrecision, AnswersAreTheSameInAnyBatch) {
  const Surface surface = make_surface({"test", BrushedSurface{192, 0.2, 40, 2, 30, 34}}, nullptr);
  const std::vector<Query> queries = hitting_queries(surface, 3, 0.01, 64);
  const std::vector<float> whole = by_triangles(surface, 1e-2, queries);
  for (std::size_t n = 0; n < queries.size(); n += 7)
    EXPECT_EQ(by_triangles(surface, 1e-2, {queries[n]}).front(), whole[n]);
}

}  // namespace
}  // namespace mica::host::triangle_precision_test
