#include <gtest/gtest.h>

#include "host/engine/triangle_evaluator.h"
#include "host/reference/oracle.h"

namespace mica {
namespace {

// A footprint wider than the map answers like the oracle, which sums every period, and costs no more than one
// of 0.8.
TEST(Periods, WideFootprintsEqualTheOracle) {
  SurfaceDescription description;
  SpectrumSurface spectrum;
  spectrum.resolution = 16;
  spectrum.correlation_texels = 3;
  description.source = spectrum;
  const Surface surface = make_surface(description, nullptr);
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

}  // namespace
}  // namespace mica
