// Work-groups of different threads of a device keep to their own local memory: many queries, so that threads
// meet. Not for a simulated device, which has one. docs/devices.md says what went wrong here.
#include <gtest/gtest.h>

#include <cmath>

#include "host/methods/gaussians/mixture_evaluator.h"

namespace mica::host::groups_test {
namespace {

constexpr int kResolution = 128;
constexpr int kQueries = 30'000;

std::vector<Query> queries(const Surface& surface) {
  std::vector<Query> result;
  for (int n = 0; n < kQueries; ++n) {
    const int i = n % kResolution, j = n / kResolution % kResolution;
    Query query;
    query.footprint.mean_uv = Eigen::Vector2d(i + 0.7, j + 0.2) / kResolution;
    query.footprint.cov_uv *= std::pow(2.0 / kResolution, 2);
    query.half_vector = surface.texel(i, j);
    query.roughness = 0.02;
    result.push_back(query);
  }
  return result;
}

TEST(Groups, KeepToTheirOwnLocalMemory) {
  SpectrumSurface spectrum;
  spectrum.resolution = kResolution;
  const Surface surface = make_surface({"bumps", spectrum, Interpolation::bilinear}, nullptr);
  const std::vector<Query> questions = queries(surface);
  Device device(0);
  MixtureSettings as_vectors, as_items;
  as_vectors.wave_form = WaveForm::vectors, as_items.wave_form = WaveForm::items;
  const std::vector<float> expected = GaussianEvaluator(device, surface, as_vectors).evaluate(questions);
  const std::vector<float> densities = GaussianEvaluator(device, surface, as_items).evaluate(questions);
  int wrong = 0;
  for (int n = 0; n < kQueries; ++n) {
    ASSERT_GT(expected[n], 0.1) << "a query that asks for nothing";
    wrong += !(std::abs(densities[n] - expected[n]) <= 1e-4 * expected[n]);
  }
  EXPECT_EQ(wrong, 0) << "of " << kQueries;
}

}  // namespace
}  // namespace mica::host::groups_test
