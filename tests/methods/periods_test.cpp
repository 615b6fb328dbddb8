#include <gtest/gtest.h>

#include <cmath>

#include "host/methods/triangles/triangle_evaluator.h"
#include "host/reference/oracle.h"

namespace mica::host::periods_test {
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

/// Every kind of surface, also where the normal does not change over a quad, and on maps that are no square.
TEST(Periods, WideFootprintsOfAnySurfaceEqualTheOracle) {
  Device device(0);
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    std::vector<Eigen::Vector2d> normals;
    for (int n = 0; n < 36 * 5; ++n)
      normals.emplace_back(n % 36 < 20 ? 0.1 : 0.3 * std::sin(0.7 * n),
                           n % 36 < 20 ? 0.05 : 0.2 * std::cos(1.3 * n));
    const Surface surface(36, 5, interpolation, normals);
    std::vector<Query> queries;
    for (const double roughness : {0.004, 0.05, 0.4})
      for (const double sigma_periods : {0.81, 40.0})
        for (const Eigen::Vector2d& half : {Eigen::Vector2d(0.1, 0.05), Eigen::Vector2d(0.2, -0.1)}) {
          Query query;
          query.footprint.mean_uv = {0.4, 0.3};
          query.footprint.cov_uv = sigma_periods * sigma_periods * Eigen::Matrix2d::Identity();
          query.half_vector = half;
          query.roughness = roughness;
          queries.push_back(query);
        }
    const std::vector<float> densities = TriangleEvaluator(device, surface).evaluate(queries);
    const std::vector<double> references = reference::evaluate(surface, queries);
    for (std::size_t n = 0; n < queries.size(); ++n) {
      const double lobe_peak = 1 / (2 * 3.14159265358979323846 * std::pow(queries[n].roughness, 2));
      EXPECT_NEAR(densities[n], references[n], 1e-4 * references[n] + 1e-6 * lobe_peak)
          << n << ", interpolation " << static_cast<int>(interpolation);
    }
  }
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
}  // namespace mica::host::periods_test
