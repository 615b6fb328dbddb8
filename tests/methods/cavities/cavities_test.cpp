// The cavities' kernels against the mixture in double precision, their energy, and what they must stand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/methods/cavities/cavity_brdf.h"
#include "host/reference/cavity.h"
#include "mica/error.h"
#include "tests/methods/cavities/cavity_cases.h"

namespace mica::host::cavities_test {
namespace {

using namespace cavity_cases;

Device& device() {
  static Device only(0);
  return only;
}

CavityBrdf cavities(const Surface& surface, int per_texel = 1, LostEnergy energy = LostEnergy::exact,
                    Compensation compensation = Compensation::diffuse) {
  CavitySettings settings;
  settings.per_texel = per_texel, settings.energy = energy, settings.compensation = compensation;
  return CavityBrdf(device(), surface, settings);
}

/// Lights that mirror a view in normals under its footprint and in their duals, and near those.
std::vector<BrdfQuery> glints(const Surface& surface, const ViewQuery& view, int count) {
  std::vector<BrdfQuery> queries;
  for (int n = 0; n < count; ++n) {
    const Eigen::Vector2d place =
        view.footprint.mean_uv + view.footprint.cov_uv.diagonal().cwiseSqrt().cwiseProduct(
                                     Eigen::Vector2d(3 * uniform(6, n) - 1.5, 3 * uniform(7, n) - 1.5));
    Eigen::Vector2d normal = surface.texel(std::lround(std::floor(place.x() * surface.width())),
                                           std::lround(std::floor(place.y() * surface.height())));
    if (n % 2) normal = -normal;
    normal += view.roughness * Eigen::Vector2d(3 * uniform(8, n) - 1.5, 3 * uniform(9, n) - 1.5);
    if (normal.squaredNorm() >= 1) continue;
    const Eigen::Vector3d m(normal.x(), normal.y(), std::sqrt(1 - normal.squaredNorm()));
    queries.push_back({view.footprint, view.view, 2 * view.view.dot(m) * m - view.view, view.roughness});
  }
  return queries;
}

TEST(Cavities, AreTheMixtureOfTheReference) {
  FlakesSurface flakes;
  flakes.resolution = 128;
  for (const Surface& surface : {rough(), make(flakes, Interpolation::nearest)}) {
    for (const int per_texel : {1, 2}) {
      CavityBrdf brdf = cavities(surface, per_texel);
      const reference::CavityMixture mixture(surface, per_texel);
      for (std::uint64_t n = 0; n < 12; ++n) {
        const ViewQuery view = random_view(surface, n, n % 3 == 0 ? 0.005 : 0.02);
        const std::vector<BrdfQuery> queries = glints(surface, view, 24);
        const std::vector<BrdfValue> values = brdf.evaluate(queries);
        const std::vector<double> expected = mixture.single(queries);
        const double peak = *std::max_element(expected.begin(), expected.end());
        for (std::size_t k = 0; k < queries.size(); ++k)
          EXPECT_NEAR(values[k].single, expected[k], 1e-4 * expected[k] + 5e-6 * peak)
              << "seeds " << per_texel << ", view " << n << ", light " << k;
      }
    }
  }
}

/// The blur of a seed's facets by 32 points is off by up to 6e-3 for one seed, 7e-4 root mean square.
TEST(Cavities, LoseTheEnergyOfTheReference) {
  for (const Case& test : figure_11()) {
    for (const int per_texel : {1, 2}) {
      CavityBrdf brdf = cavities(test.surface, per_texel);
      const reference::CavityMixture mixture(test.surface, per_texel);
      for (std::uint64_t n = 0; n < 2; ++n) {
        ViewQuery view = random_view(test.surface, n, 0.02);
        view.footprint =
            footprint(test.surface, view.footprint.mean_uv, 0.5 + 0.3 * static_cast<double>(n), 0.8);
        const Albedo albedo = brdf.energy({view})[0];
        EXPECT_NEAR(albedo.single, mixture.energy(view), 5e-3) << test.name << ", view " << n;
        EXPECT_FLOAT_EQ(albedo.single + albedo.lost, 1);
      }
    }
  }
}

/// Integral of f_P(o, i) i.g over all lights: mirror images of the view in normals on a grid of the disk.
struct Furnace {
  double single = 0, multiple = 0;
};
Furnace furnace(CavityBrdf* brdf, const ViewQuery& view, double step) {
  std::vector<BrdfQuery> queries;
  std::vector<double> solid_angles;
  const int steps = static_cast<int>(1 / step);
  for (int a = -steps; a <= steps; ++a) {
    for (int b = -steps; b <= steps; ++b) {
      const Eigen::Vector2d m = step * Eigen::Vector2d(a, b);
      if (m.squaredNorm() >= 1) continue;
      const Eigen::Vector3d normal(m.x(), m.y(), std::sqrt(1 - m.squaredNorm()));
      const double cosine = view.view.dot(normal);
      const Eigen::Vector3d light = 2 * cosine * normal - view.view;
      if (cosine <= 0 || light.z() <= 0) continue;
      queries.push_back({view.footprint, view.view, light, view.roughness});
      solid_angles.push_back(4 * cosine / normal.z() * step * step);
    }
  }
  Furnace result;
  const std::vector<BrdfValue> values = brdf->evaluate(queries);
  for (std::size_t n = 0; n < values.size(); ++n) {
    result.single += solid_angles[n] * values[n].single;
    result.multiple += solid_angles[n] * values[n].multiple;
  }
  return result;
}

/// [Che19] Fig. 11: a white patch reflects all light. Draws have weights of one: this is their mean, too.
TEST(Cavities, PatchFurnaceCloses) {
  for (const LostEnergy energy : {LostEnergy::exact, LostEnergy::sampled}) {
    double lowest = 1, highest = 1;
    for (const Case& test : figure_11()) {
      CavityBrdf brdf = cavities(test.surface, 1, energy);
      for (const double sigma : {1.5, 12.0}) {
        for (const double polar : {0.0, 45.0, 75.0, 85.0}) {
          const ViewQuery view{footprint(test.surface, {0.3, 0.6}, sigma, sigma), direction(polar, 20), 0.02};
          const double all = furnace(&brdf, view, 0.012).single + brdf.energy({view})[0].lost;
          EXPECT_NEAR(all, 1, 1e-2) << test.name << ", " << sigma << " texels, " << polar << " degrees";
          EXPECT_LE(all, 1 + 5e-3) << test.name << ", " << sigma << " texels, " << polar << " degrees";
          lowest = std::min(lowest, all), highest = std::max(highest, all);
        }
      }
    }
    std::printf("%s: %.4f to %.4f\n", std::string(word_of(energy)).c_str(), lowest, highest);
  }
}

/// Maps of which neighbouring seeds are alike, and one of which they have nothing in common.
std::vector<Case> sampled_maps() {
  std::vector<Case> maps = figure_11(512);
  FlakesSurface flakes;
  flakes.resolution = 512, flakes.flake_size_texels = 2, flakes.alpha = 0.3;
  maps.push_back({"flakes", make(flakes, Interpolation::nearest)});
  return maps;
}

/// Footprints of any size and shape, up to wider than the map.
TEST(Cavities, SampledEnergyIsNearThatOfEverySeed) {
  for (const Case& test : sampled_maps()) {
    for (const int per_texel : {1, 2}) {
      CavityBrdf exact = cavities(test.surface, per_texel),
                 sampled = cavities(test.surface, per_texel, LostEnergy::sampled);
      std::vector<ViewQuery> views;
      for (std::uint64_t n = 0; n < 240; ++n) {
        views.push_back(random_view(test.surface, n, n % 2 ? 0.005 : 0.03));
        Footprint& seen = views.back().footprint;
        if (n % 8 == 0) seen.cov_uv *= 40 * uniform(20, n);
        const double lean = 0.95 * (2 * uniform(21, n) - 1);
        seen.cov_uv(0, 1) = seen.cov_uv(1, 0) = lean * std::sqrt(seen.cov_uv(0, 0) * seen.cov_uv(1, 1));
      }
      const std::vector<Albedo> of_all = exact.energy(views), of_some = sampled.energy(views);
      double worst = 0, squares = 0;
      for (std::size_t n = 0; n < views.size(); ++n) {
        const double error = of_some[n].lost - of_all[n].lost;
        worst = std::max(worst, std::abs(error)), squares += error * error;
        EXPECT_NEAR(error, 0, 0.02) << test.name << ", seeds " << per_texel << ", "
                                    << (views[n].footprint.cov_uv * 512 * 512) << " texels^2, cosine "
                                    << views[n].view.z() << " lost " << of_all[n].lost;
      }
      std::printf("%s, seeds %d: off by %.4f at most, %.4f root mean square\n", test.name.c_str(), per_texel,
                  worst, std::sqrt(squares / static_cast<double>(views.size())));
    }
  }
}

/// The two lobes of the compensation take all that is lost, for every view.
TEST(Cavities, CompensationIsWhole) {
  for (const double polar : {0.0, 45.0, 85.0, 88.0, 89.9}) {
    for (const double roughness : {0.02, 0.2}) {
      const Eigen::Vector3d view = direction(polar, 20);
      // Lights on a grid of the disk (i_x, i_y), whose area is i_z di.
      for (const Compensation kind : {Compensation::diffuse, Compensation::specular}) {
        const double width = polar > 60 ? 4 : 2;  // of the specular lobe, in roughnesses
        const double reach = kind == Compensation::diffuse ? 2 : std::min(6 * width * roughness, 2.0);
        constexpr int steps = 240;
        double sum = 0;
        for (int a = 0; a < steps; ++a) {
          for (int b = 0; b < steps; ++b) {
            const Eigen::Vector2d offset((2 * a + 1.0) / steps - 1, (2 * b + 1.0) / steps - 1);
            const Eigen::Vector2d light = reach * offset - view.head<2>();
            const double squared_cosine = 1 - light.squaredNorm();
            if (squared_cosine <= 0) continue;
            const double cosine = std::sqrt(squared_cosine);
            sum += compensation(kind, view, {light.x(), light.y(), cosine}, roughness, width) / cosine;
          }
        }
        EXPECT_NEAR(sum * std::pow(2 * reach / steps, 2), 1, 2e-3) << static_cast<int>(kind) << ", " << polar;
      }
    }
  }
  const Surface surface = rough(64);
  CavityBrdf brdf = cavities(surface, 1, LostEnergy::exact, Compensation::specular);
  const ViewQuery view{footprint(surface, {0.3, 0.6}, 3, 3), direction(45, 20), 0.05};
  const Eigen::Vector3d light = direction(47, 205);
  const BrdfValue value = brdf.evaluate({{view.footprint, view.view, light, 0.05}})[0];
  const double lost = brdf.energy({view})[0].lost;
  EXPECT_GT(value.multiple, 0);
  EXPECT_NEAR(value.multiple, lost * compensation(Compensation::specular, view.view, light, 0.05), 1e-6);
  EXPECT_EQ(value.pdf, value.single + value.multiple);

  CavitySettings wide;
  wide.compensation = Compensation::specular, wide.compensation_width = 6;
  const BrdfValue wider =
      CavityBrdf(device(), surface, wide).evaluate({{view.footprint, view.view, light, 0.05}})[0];
  EXPECT_NEAR(wider.multiple, lost * compensation(Compensation::specular, view.view, light, 0.05, 6), 1e-6);
  EXPECT_LT(wider.multiple,
            0.3f * value.multiple);  // near its peak, which falls with the square of the width
}

TEST(Cavities, DoNotDependOnTheBatch) {
  const Surface surface = rough(128);
  CavitySettings settings;
  CavityBrdf whole(device(), surface, settings);
  settings.batch_queries = 7;
  CavityBrdf small(device(), surface, settings);
  std::vector<BrdfQuery> queries;
  std::vector<SampleQuery> draws;
  for (std::uint64_t n = 0; n < 40; ++n) {
    const ViewQuery view = random_view(surface, n, 0.02);
    for (const BrdfQuery& query : glints(surface, view, 2)) queries.push_back(query);
    draws.push_back({view, n});
  }
  const std::vector<BrdfValue> a = whole.evaluate(queries), b = small.evaluate(queries);
  for (std::size_t n = 0; n < queries.size(); ++n) {
    EXPECT_EQ(a[n].single, b[n].single);
    EXPECT_EQ(a[n].multiple, b[n].multiple);
    EXPECT_EQ(a[n].single, whole.evaluate({queries[n]})[0].single);
  }
  const std::vector<BrdfSample> c = whole.sample(draws), d = small.sample(draws);
  for (std::size_t n = 0; n < draws.size(); ++n) {
    EXPECT_EQ(c[n].light, d[n].light);
    EXPECT_EQ(c[n].pdf, d[n].pdf);
  }
}

TEST(Cavities, StandHardCases) {
  std::vector<Eigen::Vector2d> normals(64 * 64);
  for (int n = 0; n < 64 * 64; ++n) {
    const double radius = n % 3 == 0 ? 0.9999999 : n % 3 == 1 ? 0.0 : 0.9999;  // at the horizon, and flat
    normals[n] = radius * Eigen::Vector2d(std::cos(n), std::sin(n));
  }
  const Surface surface(64, 64, Interpolation::bilinear, normals);
  for (const LostEnergy energy : {LostEnergy::exact, LostEnergy::sampled}) {
    for (const Compensation kind : {Compensation::diffuse, Compensation::specular}) {
      CavityBrdf brdf = cavities(surface, 1, energy, kind);
      std::vector<BrdfQuery> queries;
      std::vector<SampleQuery> draws;
      const std::vector<Eigen::Vector3d> directions = {direction(0, 0),
                                                       direction(89.99, 0),
                                                       direction(89.99, 180),
                                                       direction(89.9999, 77),
                                                       direction(45, 45),
                                                       {1, 0, 0},
                                                       {0, 0, -1},
                                                       direction(95, 0),
                                                       {-1, 0, 0},
                                                       direction(89.99, 179.999)};
      for (const double roughness : {1e-5, 0.02, 1.0}) {
        for (const double sigma : {1e-3, 2.0, 1e4}) {
          for (const Eigen::Vector3d& o : directions) {
            const ViewQuery view{footprint(surface, {0.51, 0.49}, sigma, sigma), o, roughness};
            for (const Eigen::Vector3d& i : directions) queries.push_back({view.footprint, o, i, roughness});
            draws.push_back({view, draws.size()});
          }
        }
      }
      const std::vector<BrdfValue> values = brdf.evaluate(queries);
      for (std::size_t n = 0; n < queries.size(); ++n) {
        for (const float value : {values[n].single, values[n].multiple, values[n].pdf}) {
          EXPECT_TRUE(std::isfinite(value)) << n;
          EXPECT_GE(value, 0) << n;
        }
        const bool below = queries[n].view.z() <= 0 || queries[n].light.z() <= 0;
        EXPECT_TRUE(!below || values[n].pdf == 0) << n;
      }
      for (const BrdfSample& sample : brdf.sample(draws)) {
        EXPECT_TRUE(sample.light.allFinite());
        EXPECT_TRUE(std::isfinite(sample.pdf));
        EXPECT_LE(sample.weight_single + sample.weight_multiple, 1 + 1e-6f);
      }
    }
  }
}

TEST(Cavities, AreSmall) {
  EXPECT_LE(map_structure_bytes(2048, 2048), std::size_t{64} << 20);
  const Surface surface = rough(256);
  for (const LostEnergy energy : {LostEnergy::exact, LostEnergy::sampled})
    EXPECT_EQ(cavities(surface, 1, energy).device_bytes(), map_structure_bytes(256, 256));
}

TEST(Cavities, RefuseWhatTheyDoNotTake) {
  EXPECT_THROW(cavities(rough(64), 3), UsageError);
  SpectrumSurface spectrum;
  spectrum.resolution = 64;
  EXPECT_THROW(cavities(make(spectrum, Interpolation::bicubic), 2), UsageError);
}

}  // namespace
}  // namespace mica::host::cavities_test
