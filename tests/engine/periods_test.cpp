#include <gtest/gtest.h>

#include "host/engine/triangle_evaluator.h"
#include "host/reference/oracle.h"

namespace mica {
namespace {

Surface small_map() {
  SurfaceDescription description;
  SpectrumSurface spectrum;
  spectrum.resolution = 16;
  spectrum.correlation_texels = 3;
  description.source = spectrum;
  return make_surface(description, nullptr);
}

// A footprint wider than the map answers like the oracle, which sums every period, and costs no more than one
// of 0.8.
TEST(Periods, WideFootprintsEqualTheOracle) {
  const Surface surface = small_map();
  std::vector<Query> queries;
  for (const double sigma_periods : {0.5, 0.79, 0.81, 1.5, 3.0}) {
    for (int n = 0; n < 4; ++n) {
      Query query;
      query.footprint.mean_uv = {0.2 * n, 0.3};
      const double variance = sigma_periods * sigma_periods;
      query.footprint.cov_uv << variance, 0.1 * variance, 0.1 * variance, 1.2 * variance;
      query.half_vector = surface.texel(3 * n, n);
      query.roughness = 0.03;
      queries.push_back(query);
    }
  }
  Device device(0);
  const std::vector<float> densities = TriangleEvaluator(device, surface).evaluate(queries);
  const std::vector<double> references = reference::evaluate(surface, queries);
  for (std::size_t n = 0; n < queries.size(); ++n)
    EXPECT_NEAR(densities[n], references[n], 1e-4 * references[n]) << n;
}

// A footprint that is long in one direction alone, over many periods and at any angle to the map: those that
// run along a lattice line of the map see few places of it again and again, others all of it.
TEST(Periods, LongFootprintsEqualTheOracle) {
  const Surface surface = small_map();
  std::vector<Query> queries;
  for (const Eigen::Vector2d& along :
       {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(1, 1), Eigen::Vector2d(-2, 1),
        Eigen::Vector2d(1, 0.02), Eigen::Vector2d(3, 5), Eigen::Vector2d(0.618, 1)}) {
    for (const double length : {1.2, 7.0}) {
      for (const double width : {0.02, 0.1, 0.4}) {
        const Eigen::Vector2d u = along.normalized(), v(-u.y(), u.x());
        Query query;
        query.footprint.mean_uv = {0.3, 0.8};
        query.footprint.cov_uv = length * length * u * u.transpose() + width * width * v * v.transpose();
        query.footprint.cov_uv(1, 0) = query.footprint.cov_uv(0, 1);  // rounded alike
        query.half_vector = surface.texel(5, 12);
        query.roughness = 0.05;
        queries.push_back(query);
      }
    }
  }
  Device device(0);
  const std::vector<float> densities = TriangleEvaluator(device, surface).evaluate(queries);
  const std::vector<double> references = reference::evaluate(surface, queries);
  for (std::size_t n = 0; n < queries.size(); ++n)
    EXPECT_NEAR(densities[n], references[n], 1e-4 * references[n]) << n;
}

}  // namespace
}  // namespace mica
