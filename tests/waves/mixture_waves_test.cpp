// The kernels of mixtures, as waves_test.cpp those of triangles: a handful of queries, in both forms of a
// wave.
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "host/methods/beckmanns/beckmann_brdf.h"
#include "host/methods/beckmanns/beckmann_evaluator.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/reference/beckmann_mixture.h"
#include "host/reference/gaussian_mixture.h"

namespace mica::host::mixture_waves_test {
namespace {

constexpr int kResolution = 64;
constexpr double kRoughness = 0.02;

Surface bumps(Interpolation interpolation) {
  SpectrumSurface spectrum;
  spectrum.resolution = kResolution;
  spectrum.correlation_texels = 4;
  return make_surface({"bumps", spectrum, interpolation}, nullptr);
}

/// Narrow and wide footprints across the map's edge, and a half vector near a normal of theirs.
std::vector<Query> queries(const Surface& surface) {
  std::vector<Query> result;
  for (const double sigma_texels : {0.4, 2.5}) {
    Query query;
    query.footprint.mean_uv = Eigen::Vector2d(0.7 / kResolution, 0.999);
    query.footprint.cov_uv *= std::pow(sigma_texels / kResolution, 2);
    query.half_vector = surface.texel(0, -1) + Eigen::Vector2d(0.5 * kRoughness, 0);
    query.roughness = kRoughness;
    result.push_back(query);
  }
  return result;
}

class MixtureWaves : public testing::TestWithParam<std::tuple<WaveForm, Interpolation>> {
 protected:
  MixtureSettings settings() const {
    MixtureSettings settings;
    settings.wave_form = std::get<0>(GetParam());
    return settings;
  }
  Surface surface_ = bumps(std::get<1>(GetParam()));
  std::vector<Query> queries_ = queries(surface_);
  Device device_{0};
};

TEST_P(MixtureWaves, GaussiansAreTheirSum) {
  const std::vector<float> densities = GaussianEvaluator(device_, surface_, settings()).evaluate(queries_);
  const std::vector<double> expected = reference::GaussianMixture(surface_, 1).evaluate(queries_);
  for (std::size_t n = 0; n < queries_.size(); ++n) {
    EXPECT_GT(expected[n], 0.1) << "a query that asks for nothing";
    EXPECT_NEAR(densities[n], expected[n], 5e-4 * expected[n]) << "query " << n;
  }
}

TEST_P(MixtureWaves, BeckmannsAreTheirSum) {
  const std::vector<float> densities = BeckmannEvaluator(device_, surface_, settings()).evaluate(queries_);
  const reference::BeckmannMixture mixture(surface_, 1);
  for (std::size_t n = 0; n < queries_.size(); ++n) {
    const double expected = reference::BeckmannMixture::density(
        mixture.lobes(queries_[n].footprint, kRoughness), queries_[n].half_vector);
    EXPECT_GT(expected, 0.1) << "a query that asks for nothing";
    EXPECT_NEAR(densities[n], expected, 1e-3 * expected) << "query " << n;
  }
}

/// D by the pdf, and the areas by f A(i) = D A(i) / (4 I(o) I(i)). [Che18] Eq. 7
TEST_P(MixtureWaves, PatchesHaveTheirDensityAndAreas) {
  const reference::BeckmannMixture mixture(surface_, 1);
  const Eigen::Vector3d view = Eigen::Vector3d(0.5, 0.2, 0.7).normalized();
  for (const auto& [masking, allowed] :
       {std::pair(Masking::exact, 1e-3), std::pair(Masking::filtered, 0.05)}) {
    BeckmannBrdfSettings settings;
    settings.masking = masking;
    settings.wave_form = std::get<0>(GetParam());
    const auto brdf = std::make_unique<BeckmannBrdf>(device_, surface_, settings);
    for (const Query& query : queries_) {
      const Eigen::Vector2d& h = query.half_vector;
      const Eigen::Vector3d half(h.x(), h.y(), std::sqrt(1 - h.squaredNorm()));
      const Eigen::Vector3d light = 2 * view.dot(half) * half - view;
      const BrdfValue value = brdf->evaluate({{query.footprint, view, light, kRoughness}})[0];
      const std::vector<reference::SlopeLobe> lobes = mixture.lobes(query.footprint, kRoughness);
      const double density = value.pdf * 4 * view.dot(half) / half.z();
      EXPECT_NEAR(density / reference::BeckmannMixture::density(lobes, h), 1, 1e-3);
      const double expected = reference::BeckmannMixture::scattering(lobes, view, light);
      EXPECT_NEAR(value.single / expected, 1, allowed + 1e-3);  // of the areas, and of D
    }
  }
}

std::string name_of(const testing::TestParamInfo<MixtureWaves::ParamType>& info) {
  const auto [form, interpolation] = info.param;
  return std::string(form == WaveForm::vectors ? "Vectors" : "Items") +
         (interpolation == Interpolation::nearest ? "Nearest" : "Bilinear");
}

INSTANTIATE_TEST_SUITE_P(Variants, MixtureWaves,
                         testing::Combine(testing::Values(WaveForm::vectors, WaveForm::items),
                                          testing::Values(Interpolation::nearest, Interpolation::bilinear)),
                         name_of);

}  // namespace
}  // namespace mica::host::mixture_waves_test
