// Every variant of the kernels on a handful of queries: few enough to be run on a simulated device that
// watches each access to memory (see tests/waves/simulate.sh). PoCL 3.1 takes minutes and gigabytes to
// compile the barriers of the items form, so CTest runs that one on the simulated device alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "host/methods/triangles/triangle_evaluator.h"
#include "host/reference/oracle.h"

namespace mica::host::waves_test {
namespace {

constexpr int kResolution = 64;

Surface bumps(Interpolation interpolation) {
  SpectrumSurface spectrum;
  spectrum.resolution = kResolution;
  spectrum.correlation_texels = 4;
  return make_surface({"bumps", spectrum, interpolation}, nullptr);
}

/// Narrow and wide footprints, across the map's edges, and half vectors on and off the normals.
std::vector<Query> queries(const Surface& surface) {
  std::vector<Query> result;
  for (const double sigma_texels : {0.4, 3.0}) {
    for (const double roughness : {0.005, 0.05}) {
      for (const long texel : {0L, 37L}) {
        Query query;
        query.footprint.mean_uv = Eigen::Vector2d((texel + 0.7) / kResolution, 0.999);
        query.footprint.cov_uv *= std::pow(sigma_texels / kResolution, 2);
        query.half_vector = surface.texel(texel, -1) + Eigen::Vector2d(0.5 * roughness, 0);
        query.roughness = roughness;
        result.push_back(query);
      }
    }
  }
  return result;
}

class Waves : public testing::TestWithParam<std::tuple<WaveForm, Interpolation>> {};

TEST_P(Waves, AgreeWithTheOracle) {
  const auto [form, interpolation] = GetParam();
  const Surface surface = bumps(interpolation);
  const std::vector<Query> questions = queries(surface);
  Device device(0);
  TriangleSettings settings;
  settings.wave_form = form;
  const std::vector<float> densities = TriangleEvaluator(device, surface, settings).evaluate(questions);

  const std::vector<double> expected = reference::evaluate(surface, questions);
  for (std::size_t n = 0; n < questions.size(); ++n) {
    EXPECT_GT(expected[n], 0.1) << "a query that asks for nothing";
    EXPECT_NEAR(densities[n], expected[n], 1e-4 * expected[n]) << "query " << n;
  }
}

std::string name_of(const testing::TestParamInfo<Waves::ParamType>& info) {
  const char* const forms[] = {"Vectors", "Items"};
  const char* const interpolations[] = {"Nearest", "Bilinear", "Bicubic"};
  const auto [form, interpolation] = info.param;
  return std::string(forms[static_cast<int>(form)]) + interpolations[static_cast<int>(interpolation)];
}

INSTANTIATE_TEST_SUITE_P(Variants, Waves,
                         testing::Combine(testing::Values(WaveForm::vectors, WaveForm::items),
                                          testing::Values(Interpolation::nearest, Interpolation::bilinear,
                                                          Interpolation::bicubic)),
                         name_of);

}  // namespace
}  // namespace mica::host::waves_test
