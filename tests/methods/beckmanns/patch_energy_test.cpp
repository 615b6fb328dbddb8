// What patches of `beckmanns` scatter of the light of a white furnace: never more than they get.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/base/masking.h"
#include "host/base/random.h"
#include "host/methods/evaluator.h"
#include "host/methods/patch_brdf.h"
#include "host/methods/registry.h"
#include "host/reference/beckmann_mixture.h"
#include "host/surface/texel_footprint.h"

namespace mica::host::patch_energy_test {
namespace {

Device& device() {
  static Device shared(0);  // programs are built once for all tests
  return shared;
}

std::unique_ptr<PatchBrdf> beckmanns(const Surface& surface, Masking masking,
                                     EnergyBound bound = EnergyBound::none) {
  return make_patch_brdf(
      "beckmanns", device(), surface,
      {{"masking", std::string(word_of(masking))}, {"energy-bound", std::string(word_of(bound))}});
}

Eigen::Vector3d direction(double degrees, double azimuth) {
  const double polar = degrees * M_PI / 180;
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

/// The integral of the BRDF over all lights: mirror images of the view in normals whose slopes lie on a grid,
/// d i = 4 <o, h> d h and d h = h.z^3 d slope.
double scattered(PatchBrdf* brdf, const ViewQuery& view) {
  constexpr double reach = 4, step = 0.06;  // finer than the roughness of the tests
  std::vector<BrdfQuery> queries;
  std::vector<double> areas;
  for (double x = -reach; x <= reach; x += step) {
    for (double y = -reach; y <= reach; y += step) {
      const Eigen::Vector3d h = Eigen::Vector3d(-x, -y, 1).normalized();
      const double cosine = h.dot(view.view);
      const Eigen::Vector3d light = 2 * cosine * h - view.view;
      if (cosine <= 0 || light.z() <= 0) continue;
      queries.push_back({view.footprint, view.view, light, view.roughness});
      areas.push_back(step * step * std::pow(h.z(), 3) * 4 * cosine);
    }
  }
  const std::vector<BrdfValue> values = brdf->evaluate(queries);
  double sum = 0;
  for (std::size_t n = 0; n < values.size(); ++n) sum += values[n].single * areas[n];
  return sum;
}

/// A map of one normal is a smooth lobe about it: from above it mirrors all light, whatever its tilt.
TEST(PatchEnergy, AMapOfOneNormalLosesNothingFromAbove) {
  for (const double slope : {0.0, 0.25, 0.5}) {
    const Eigen::Vector2d normal = -slope / std::sqrt(1 + slope * slope) * Eigen::Vector2d(0.8, -0.6);
    const Surface surface(16, 16, Interpolation::bilinear, std::vector<Eigen::Vector2d>(16 * 16, normal));
    for (const Masking masking : {Masking::exact, Masking::filtered}) {
      const auto brdf = beckmanns(surface, masking);
      const ViewQuery above{make_footprint(surface, {0.5, 0.5}, 2, 2, 0), Eigen::Vector3d::UnitZ(), 0.08};
      EXPECT_NEAR(scattered(brdf.get(), above), 1, 2e-3) << "slope " << slope;
      EXPECT_NEAR(brdf->energy({above})[0].single, 1, 2e-3) << "slope " << slope;
    }
  }
}

/// There the one lobe that filtered masking takes for a patch is the patch's own.
TEST(PatchEnergy, FilteredMaskingOfOneNormalIsExact) {
  const Eigen::Vector2d normal(0.2, -0.15);
  const Surface surface(16, 16, Interpolation::bilinear, std::vector<Eigen::Vector2d>(16 * 16, normal));
  const auto exact = beckmanns(surface, Masking::exact), filtered = beckmanns(surface, Masking::filtered);
  for (const double azimuth : {0.3, 1.9, 4.0}) {
    const ViewQuery view{make_footprint(surface, {0.5, 0.5}, 2, 2, 0), direction(78, azimuth), 0.2};
    const double expected = scattered(exact.get(), view);
    EXPECT_NEAR(scattered(filtered.get(), view), expected, 5e-3 * expected) << azimuth;
  }
}

/// Patches of 0.4 to 12 texels that lean anywhere, as seen up to 85 degrees from g.
std::vector<ViewQuery> patches(const Surface& surface, int count) {
  std::vector<ViewQuery> views;
  for (int n = 0; n < count; ++n) {
    const auto random = [&](int stream) { return random_unit(5, stream, n); };
    const double sigma = 0.4 * std::pow(30, random(0));
    const Footprint footprint = make_footprint(surface, {random(1), random(2)}, sigma,
                                               sigma * (0.3 + 0.7 * random(3)), 3 * random(4));
    views.push_back({footprint, direction(85 * std::sqrt(random(5)), 6.3 * random(6)), 0.1});
  }
  return views;
}

/// [Che18] Eq. 7 with the patch's own cosine: the integral is the mean of G1(i) <= 1 over visible normals.
TEST(PatchEnergy, NoPatchScattersMoreThanItGets) {
  double most = 0, least = 1, most_filtered = 0, apart = 0;
  for (const double rms_slope : {0.3, 0.6}) {
    const Surface surface =
        make_surface({"test", SpectrumSurface{64, rms_slope, 6, 3}, Interpolation::bilinear}, nullptr);
    const auto exact = beckmanns(surface, Masking::exact), filtered = beckmanns(surface, Masking::filtered);
    for (const ViewQuery& view : patches(surface, 20)) {
      const double energy = scattered(exact.get(), view);
      most = std::max(most, energy), least = std::min(least, energy);
      EXPECT_LE(energy, 1.005) << "view " << view.view.transpose();
      apart = std::max(apart, std::abs(exact->energy({view})[0].single - energy));
      most_filtered = std::max(most_filtered, scattered(filtered.get(), view));
    }
  }
  std::printf("%.4f to %.4f of the light; %.4f at most by filtered masking; energy is off by %.4f\n", least,
              most, most_filtered, apart);
  EXPECT_LE(apart, 0.03);  // three standard errors of 1024 random normals whose shares spread by 0.3
}

/// What a direction sees of the patch is at least what its lobes show: no masking gains then, and exchanging
/// view and light changes nothing but the cosine of what receives.
TEST(PatchEnergy, ABoundHoldsWhateverTheMasking) {
  const Surface surface =
      make_surface({"test", SpectrumSurface{64, 0.6, 6, 3}, Interpolation::bilinear}, nullptr);
  const auto geometric = beckmanns(surface, Masking::geometric),
             bounded = beckmanns(surface, Masking::geometric, EnergyBound::patch),
             filtered = beckmanns(surface, Masking::filtered, EnergyBound::patch);
  double most = 0, gain = 0;
  for (const ViewQuery& view : patches(surface, 20)) {
    gain = std::max(gain, scattered(geometric.get(), view));
    for (PatchBrdf* brdf : {bounded.get(), filtered.get()}) {
      const double energy = scattered(brdf, view);
      most = std::max(most, energy);
      EXPECT_LE(energy, 1.005) << "view " << view.view.transpose();
    }
    const Eigen::Vector3d light = direction(40, 1);
    const double there = bounded->evaluate({{view.footprint, view.view, light, view.roughness}})[0].single,
                 back = bounded->evaluate({{view.footprint, light, view.view, view.roughness}})[0].single;
    EXPECT_NEAR(there * view.view.z(), back * light.z(), 1e-4 * there);
  }
  std::printf("geometric masking: %.3f at most, %.4f with a bound\n", gain, most);
  EXPECT_GT(gain, 1.1);
}

}  // namespace
}  // namespace mica::host::patch_energy_test
