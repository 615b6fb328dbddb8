// `smooth` against one Gaussian with the moments of all lobes of the double-precision mixture.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstdio>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/methods/smooth/smooth_evaluator.h"
#include "host/reference/beckmann_mixture.h"
#include "host/surface/texel_footprint.h"
#include "tests/methods/gaussians/mixture_surfaces.h"

namespace mica::host::smooth_test {
namespace {

Device& device() {
  static Device shared(0);
  return shared;
}

/// The lobe of a footprint: mean and covariance of its lobes' slopes.
reference::SlopeLobe moments(const std::vector<reference::SlopeLobe>& lobes) {
  reference::SlopeLobe all;
  for (const reference::SlopeLobe& lobe : lobes) {
    all.mean += lobe.weight * lobe.mean;
    all.covariance += lobe.weight * (lobe.covariance + lobe.mean * lobe.mean.transpose());
  }
  all.covariance -= all.mean * all.mean.transpose();
  all.weight = 1;
  return all;
}

/// The pyramid's ripple is 1e-4 of what slopes vary by; a tenth of a percent at the lobe's shoulders.
void expect_moments(const Surface& surface) {
  SmoothEvaluator smooth(device(), surface);
  const reference::BeckmannMixture mixture(surface, 1);
  constexpr double roughness = 0.01;
  double worst = 0;
  for (const Eigen::Vector2d& sigma :
       {Eigen::Vector2d(0.3, 0.3), Eigen::Vector2d(1.1, 0.9), Eigen::Vector2d(2.5, 2), Eigen::Vector2d(9, 9),
        Eigen::Vector2d(30, 1), Eigen::Vector2d(40, 25)}) {
    for (const double angle : {0.0, 0.7, 2.1}) {
      const Footprint footprint = make_footprint(surface, {0.21, 0.83}, sigma.x(), sigma.y(), angle);
      const reference::SlopeLobe lobe = moments(mixture.lobes(footprint, roughness));
      std::vector<Query> queries;
      const Eigen::Vector2d deviations = lobe.covariance.diagonal().cwiseSqrt();
      for (const double x : {-1.5, 0.0, 1.0})
        for (const double y : {-1.0, 0.0, 2.0}) {
          const Eigen::Vector2d slope = lobe.mean + deviations.cwiseProduct(Eigen::Vector2d(x, y));
          queries.push_back({footprint, -slope / std::sqrt(1 + slope.squaredNorm()), roughness});
        }
      const std::vector<float> densities = smooth.evaluate(queries);
      double peak = 0;
      for (const Query& query : queries)
        peak = std::max(peak, reference::BeckmannMixture::density({lobe}, query.half_vector));
      for (std::size_t n = 0; n < queries.size(); ++n) {
        const double expected = reference::BeckmannMixture::density({lobe}, queries[n].half_vector);
        worst = std::max(worst, std::abs(densities[n] - expected) / peak);
        EXPECT_NEAR(densities[n], expected, 5e-3 * peak)
            << "footprint " << sigma.transpose() << " at " << angle << ", n " << n;
      }
    }
  }
  std::printf("off by %.1e of the peak at most\n", worst);
}

TEST(Smooth, HasTheMomentsOfTheFootprintOnNoise) {
  expect_moments(mixture_spectrum());
}
TEST(Smooth, HasTheMomentsOfTheFootprintOnBrushedMetal) {
  expect_moments(mixture_brushed());
}

/// A footprint of many periods sees the map as a whole.
TEST(Smooth, SeesTheWholeMap) {
  const Surface surface = mixture_brushed();
  SmoothEvaluator smooth(device(), surface);
  reference::SlopeLobe lobe;
  for (const Eigen::Vector2d& s : surface.normals()) {
    const Eigen::Vector2d slope = -s / std::sqrt(1 - s.squaredNorm());
    lobe.mean += slope / static_cast<double>(surface.normals().size());
  }
  lobe.weight = 1;
  const Query query{{{0.3, 0.3}, Eigen::Matrix2d::Identity() * 25.0}, {0.0, 0.0}, 0.3};
  // At this roughness the map's own covariance, 0.01, is a small part, of which texels instead of all points
  // are off by less than a tenth.
  for (const Eigen::Vector2d& s : surface.normals()) {
    const Eigen::Vector2d offset = -s / std::sqrt(1 - s.squaredNorm()) - lobe.mean;
    lobe.covariance += offset * offset.transpose() / static_cast<double>(surface.normals().size());
  }
  lobe.covariance += 0.09 * Eigen::Matrix2d::Identity();
  EXPECT_NEAR(smooth.evaluate({query})[0], reference::BeckmannMixture::density({lobe}, {0, 0}),
              0.03 * reference::BeckmannMixture::density({lobe}, {0, 0}));
}

/// The integral of D over the disk.
double integral(SmoothEvaluator* smooth, const Footprint& footprint, double roughness) {
  const int side = static_cast<int>(std::ceil(4 / roughness));  // grid points half a roughness apart
  std::vector<Query> queries;
  for (int n = 0; n < side * side; ++n) {
    const Eigen::Vector2d s((2.0 * (n % side) + 1) / side - 1, (2.0 * (n / side) + 1) / side - 1);
    if (s.norm() < 1) queries.push_back({footprint, s, roughness});
  }
  double sum = 0;
  for (const float density : smooth->evaluate(queries)) sum += density;
  return sum * 4 / (side * side);
}

/// A covariance of slopes that are all alike, or nearly so under a close footprint, is no small difference of
/// large squares.
TEST(Smooth, IntegratesToOneWhereSlopesHardlyDiffer) {
  for (const Eigen::Vector2d& normal :
       {Eigen::Vector2d(0.098, -0.059), Eigen::Vector2d(-0.4, 0.3), Eigen::Vector2d(0.5, 0.6)}) {
    const Surface plane(32, 32, Interpolation::bilinear, std::vector<Eigen::Vector2d>(32 * 32, normal));
    SmoothEvaluator smooth(device(), plane);
    for (const double sigma : {0.7, 4.0, 200.0})
      EXPECT_NEAR(integral(&smooth, make_footprint(plane, {0.4, 0.6}, sigma, sigma, 0), 0.02), 1, 5e-3)
          << normal.transpose() << ", footprint " << sigma;
    // A lobe this narrow is the same in slopes and on the disk.
    const double peak = 1 / (2 * kPi * 1e-3 * 1e-3);
    const Query query{make_footprint(plane, {0.4, 0.6}, 2, 2, 0), normal, 1e-3};
    EXPECT_NEAR(smooth.evaluate({query})[0], peak, 0.01 * peak) << normal.transpose();
  }
  const Surface flakes =
      make_surface({"flakes", FlakesSurface{64, 12, 0.2, 5}, Interpolation::nearest}, nullptr);
  SmoothEvaluator smooth(device(), flakes);
  for (int n = 0; n < 12; ++n) {
    const Footprint footprint =
        make_footprint(flakes, {random_unit(1, 0, n), random_unit(1, 1, n)}, 0.8, 0.8, 0);
    EXPECT_NEAR(integral(&smooth, footprint, 0.02), 1, 5e-3) << n;
  }
}

}  // namespace
}  // namespace mica::host::smooth_test
