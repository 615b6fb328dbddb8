// Light that bounces once in V-shaped grooves, by brute force: rays are traced through the two walls of a
// groove, without a formula of the model. Where they go is what the cavities say. And the cavities' own
// draws.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host/methods/cavities/cavity_brdf.h"
#include "tests/methods/cavities/cavity_cases.h"
#include "tests/statistics/chi_square.h"

namespace mica::host::cavity_walk_test {
namespace {

using namespace cavity_cases;
using Random = std::mt19937_64;

double random_unit(Random& random) {
  return std::uniform_real_distribution<double>(0, 1)(random);
}

/// A groove of width 1 in the plane of height 0, across x: walls from (0, 0) and (1, 0) down to (1/2, -slope
/// / 2).
struct Groove {
  double slope;

  double height(double x) const { return -slope * std::min(x, 1 - x); }

  /// Which wall a ray meets that enters at `x` and travels by -(o_x, o_z).
  int wall_below(double x, double o_x, double o_z) const {
    for (const int wall : {0, 1}) {
      // x - o_x tau = a place on the wall, -o_z tau its height.
      const double rise = wall == 0 ? -slope : slope,
                   base = wall == 0 ? 0 : -slope;  // height = base + rise * place
      const double divisor = o_z - rise * o_x;
      const double tau = -(base + rise * x) / divisor, place = x - o_x * tau;
      const double low = wall == 0 ? 0 : 0.5;
      if (divisor != 0 && tau >= 0 && place >= low && place <= low + 0.5) return wall;
    }
    return 0;  // grazing an edge
  }

  /// Whether a ray leaves that starts at `x` on a wall.
  bool leaves(double x, double i_x, double i_z) const {
    if (i_z <= 0) return false;
    const double exit = x - height(x) / i_z * i_x;
    return exit >= 0 && exit <= 1;
  }
};

/// Seeds of a map and their weights about a footprint, one a texel.
class Seeds {
 public:
  Seeds(const Surface& surface, const Footprint& footprint) {
    const double h_variance = 1 / (8 * std::log(2.0));
    const Eigen::Vector2d size(surface.width(), surface.height()),
        mean = footprint.mean_uv.cwiseProduct(size);
    const Eigen::Vector2d variance =
        footprint.cov_uv.diagonal().cwiseProduct(size.cwiseAbs2()) + Eigen::Vector2d(h_variance, h_variance);
    const long reach = std::lround(6 * std::sqrt(variance.maxCoeff())) + 1;
    double sum = 0;
    for (long j = -reach; j <= reach; ++j) {
      for (long i = -reach; i <= reach; ++i) {
        const long texel_i = std::lround(mean.x()) + i, texel_j = std::lround(mean.y()) + j;
        const Eigen::Vector2d offset = Eigen::Vector2d(texel_i + 0.5, texel_j + 0.5) - mean;
        sum += std::exp(-0.5 * offset.cwiseAbs2().cwiseQuotient(variance).sum());
        sums_.push_back(sum);
        normals_.push_back(surface.texel(texel_i, texel_j));
      }
    }
  }
  const Eigen::Vector2d& pick(double uniform) const {
    const auto found = std::upper_bound(sums_.begin(), sums_.end(), uniform * sums_.back());
    return normals_[std::min<std::size_t>(found - sums_.begin(), normals_.size() - 1)];
  }

 private:
  std::vector<double> sums_;
  std::vector<Eigen::Vector2d> normals_;
};

/// One walk: where light from the view goes after one bounce; z = 0 when it stays inside. Masking and
/// shadowing are independent [Che19 Eq. 6]: the light leaves from any place of the wall that was met.
Eigen::Vector3d walk(const Seeds& seeds, const ViewQuery& view, Random& random) {
  const Eigen::Vector3d inside = Eigen::Vector3d::Zero();
  std::normal_distribution<double> normal;
  const Eigen::Vector2d facet =
      seeds.pick(random_unit(random)) + view.roughness * Eigen::Vector2d(normal(random), normal(random));
  if (facet.squaredNorm() >= 1) return inside;
  // The groove runs across the facet's tilt: its left wall looks to the right.
  const Eigen::Vector2d right = facet.normalized();
  const double height = std::sqrt(1 - facet.squaredNorm());
  const Groove groove{facet.norm() / height};
  const int wall = groove.wall_below(random_unit(random), view.view.head<2>().dot(right), view.view.z());
  const Eigen::Vector2d side = wall == 0 ? facet : Eigen::Vector2d(-facet);
  const Eigen::Vector3d n(side.x(), side.y(), height);
  const Eigen::Vector3d light = 2 * n.dot(view.view) * n - view.view;
  const double place = 0.5 * (wall + random_unit(random));
  return groove.leaves(place, light.head<2>().dot(right), light.z()) ? light : inside;
}

struct Scene {
  std::string name;
  Surface surface;
  double sigma, polar, azimuth;
};
std::vector<Scene> scenes() {
  return {{"rough from above", rough(), 2, 10, 30},
          {"rough from aside", rough(), 6, 65, 200},
          {"scratched, grazing", scratched(), 3, 73, 101.25},
          {"brushed, across", brushed(), 4, 50, 0}};
}

constexpr double kRoughness = 0.06;
const statistics::SphereBins kBins(16, 16);

/// Integrals over the bins of what `part` takes of the answers.
template <typename Part>
std::vector<double> integrals(CavityBrdf* brdf, const ViewQuery& view, const Part& part) {
  constexpr int points =
      14;  // a bin and axis, 0.014 apart: the lobes are 0.04 wide and more, and the narrow one is mid-bin
  return kBins.integrate(
      [&](const std::vector<Eigen::Vector3d>& lights) {
        std::vector<BrdfQuery> queries;
        std::vector<std::size_t> places;
        for (std::size_t n = 0; n < lights.size(); ++n) {
          if (lights[n].z() <= 0) continue;
          queries.push_back({view.footprint, view.view, lights[n], view.roughness});
          places.push_back(n);
        }
        std::vector<double> densities(lights.size());
        const std::vector<BrdfValue> values = brdf->evaluate(queries);
        for (std::size_t n = 0; n < places.size(); ++n) densities[places[n]] = part(values[n]);
        return densities;
      },
      points);
}

TEST(CavityWalk, ConvergesToTheSingleScattering) {
  constexpr int walks = 400000;
  Device device(0);
  int tests = 0;
  double largest = 0;
  for (const Scene& scene : scenes()) {
    CavityBrdf brdf(device, scene.surface);
    const ViewQuery view{footprint(scene.surface, {0.31, 0.72}, scene.sigma, 0.7 * scene.sigma),
                         direction(scene.polar, scene.azimuth), kRoughness};
    const std::vector<double> expected =
        integrals(&brdf, view, [](const BrdfValue& value) { return value.single; });
    const Seeds seeds(scene.surface, view.footprint);
    Random random(1);
    std::vector<double> seen(kBins.size() + 1);
    for (int n = 0; n < walks; ++n) {
      const Eigen::Vector3d light = walk(seeds, view, random);
      ++seen[light.z() > 0 ? kBins.bin(light) : kBins.size()];
    }
    std::vector<double> shares = expected;
    shares.push_back(brdf.energy({view})[0].lost);
    for (std::size_t bin = 0; bin < shares.size(); ++bin) {
      const double variance = walks * shares[bin] * (1 - shares[bin]);
      if (variance < 100) continue;
      // The points of a bin are off by up to 4e-3 of it, and those of the blur by 1e-3 of all that is lost.
      const double slack = walks * (bin < kBins.size() ? 4e-3 * shares[bin] : 1e-3);
      const double z = (std::abs(seen[bin] - walks * shares[bin]) - slack) / std::sqrt(variance);
      largest = std::max(largest, z), ++tests;
      // One of 4 * 129 tests by chance with probability 0.01 [Sidak]: 4.27 standard deviations.
      EXPECT_LE(z, 4.27) << scene.name << ", bin " << bin << ": " << seen[bin] << " of "
                         << walks * shares[bin];
    }
  }
  EXPECT_GE(tests, 100);
  std::printf("%d bins, largest z %.2f\n", tests, largest);
}

/// [Che19] Algorithm 1: directions fall as their density says.
TEST(CavityDraws, FallAsTheirDensity) {
  constexpr std::size_t draws = 50000;
  Device device(0);
  int per_texel = 1;
  for (const Scene& scene : scenes()) {
    per_texel = 3 - per_texel;  // 1 and 2 by turns
    for (const Compensation kind : {Compensation::diffuse, Compensation::specular}) {
      CavitySettings settings;
      settings.compensation = kind, settings.per_texel = per_texel;
      CavityBrdf brdf(device, scene.surface, settings);
      const ViewQuery view{footprint(scene.surface, {0.31, 0.72}, scene.sigma, 0.7 * scene.sigma),
                           direction(scene.polar, scene.azimuth), kRoughness};
      std::vector<SampleQuery> queries(draws);
      for (std::size_t n = 0; n < draws; ++n) queries[n] = {view, 7 + n};
      std::vector<Eigen::Vector3d> lights;
      for (const BrdfSample& sample : brdf.sample(queries))
        if (sample.pdf > 0) lights.push_back(sample.light.cast<double>());
      const statistics::ChiSquare test = statistics::chi_square_of_directions(
          kBins, lights, draws, integrals(&brdf, view, [](const BrdfValue& value) { return value.pdf; }));
      EXPECT_GE(test.p_value, statistics::sidak(0.01, 8))
          << scene.name << ", " << word_of(kind) << ", seeds " << per_texel << ": chi-square "
          << test.statistic << " of " << test.degrees_of_freedom;
    }
  }
}

/// Weights are 1, and never more: [Che19] sec. 3.6.
TEST(CavityDraws, HaveWeightsOfOne) {
  Device device(0);
  for (const LostEnergy energy : {LostEnergy::exact, LostEnergy::sampled}) {
    for (const Case& test : figure_11()) {
      CavitySettings settings;
      settings.energy = energy;
      CavityBrdf brdf(device, test.surface, settings);
      std::vector<SampleQuery> queries;
      for (std::uint64_t n = 0; n < 4096; ++n) queries.push_back({random_view(test.surface, n, 0.02), n});
      int nothing = 0;
      for (const BrdfSample& sample : brdf.sample(queries)) {
        if (sample.pdf == 0) ++nothing;
        ASSERT_LE(sample.weight_single + sample.weight_multiple, 1 + 1e-6f);
        ASSERT_TRUE(sample.pdf == 0 || sample.weight_single + sample.weight_multiple >= 1 - 1e-6f);
      }
      EXPECT_LE(nothing, 40)
          << test.name;  // where the blur's points find nothing lost, and one in a thousand is
    }
  }
}

}  // namespace
}  // namespace mica::host::cavity_walk_test
