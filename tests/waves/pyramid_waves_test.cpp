// The pyramid's kernel in both forms of a wave and both widths of a record's numbers.
#include <gtest/gtest.h>

#include <cmath>

#include "host/base/constants.h"
#include "host/methods/map/map_query.h"
#include "host/methods/pyramid/pyramid_level_batches.h"
#include "host/methods/pyramid/pyramid_query.h"
#include "host/reference/oracle.h"

namespace mica::host::pyramid_waves_test {
namespace {

constexpr int kResolution = 32;

Surface bumps() {
  std::vector<Eigen::Vector2d> normals;
  for (int n = 0; n < kResolution * kResolution; ++n) {
    const double x = 2 * kPi * (n % kResolution) / kResolution, y = 2 * kPi * (n / kResolution) / kResolution;
    normals.emplace_back(0.1 * std::sin(3 * x + std::cos(y)), 0.1 * std::cos(2 * y + std::sin(x)));
  }
  return Surface(kResolution, kResolution, Interpolation::bilinear, std::move(normals));
}

std::vector<Query> queries(const Surface& surface) {
  std::vector<Query> result;
  for (const double u : {0.01, 0.4, 0.7}) {
    Query query;
    query.footprint.mean_uv = Eigen::Vector2d(u, 0.99);
    query.footprint.cov_uv *= std::pow(12.0 / kResolution, 2);
    query.half_vector = surface.texel(std::lround(u * kResolution), -1) + Eigen::Vector2d(0.02, 0);
    query.roughness = 0.04;
    result.push_back(query);
  }
  return result;
}

class PyramidWaves : public testing::TestWithParam<std::tuple<WaveForm, bool>> {};

TEST_P(PyramidWaves, AgreeWithTheOracle) {
  const auto [form, compact] = GetParam();
  const Surface surface = bumps();
  const std::vector<Query> questions = queries(surface);
  Device device(0);
  std::vector<float> densities;
  build_moment_pyramid(surface, {0.03, 16, compact}, [&](int block, const PyramidLevel& level) {
    if (block != 16) return;
    PyramidLevelBatches batches(device, level, form, 64);
    std::vector<device_types::mica_pyramid_query> sent;
    for (const Query& query : questions)
      sent.push_back(to_pyramid_query(query, level.shape, surface.interpolation(), cutoff_for(1e-4), false));
    densities = batches.start(std::move(sent))->wait();
  });
  const std::vector<double> expected = reference::evaluate(surface, questions);
  for (std::size_t n = 0; n < questions.size(); ++n) {
    EXPECT_GT(expected[n], 0.1) << "a query that asks for nothing";
    EXPECT_NEAR(densities[n], expected[n], 0.02 * expected[n]) << "query " << n;
  }
}

std::string name_of(const testing::TestParamInfo<PyramidWaves::ParamType>& info) {
  const auto [form, compact] = info.param;
  return std::string(form == WaveForm::vectors ? "Vectors" : "Items") + (compact ? "Compact" : "Whole");
}

INSTANTIATE_TEST_SUITE_P(Variants, PyramidWaves,
                         testing::Combine(testing::Values(WaveForm::vectors, WaveForm::items),
                                          testing::Bool()),
                         name_of);

}  // namespace
}  // namespace mica::host::pyramid_waves_test
