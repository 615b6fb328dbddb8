// What 8 bits cost a P-NDF, and what comes back: against the float maps that the integers came from.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "host/base/random.h"
#include "host/surface/interpolate.h"
#include "host/surface/map_precision.h"
#include "host/surface/surface.h"

namespace mica::host::precision_test {
namespace {

constexpr double kStep = 2.0 / 255;

/// As a PNG of 8 bits tells it.
std::vector<Eigen::Vector2d> rounded(const Surface& surface) {
  std::vector<Eigen::Vector2d> normals;
  const auto round = [](double s) { return std::round((s + 1) / kStep) * kStep - 1; };
  for (const Eigen::Vector2d& s : surface.normals()) {
    const Eigen::Vector3d n(round(s.x()), round(s.y()), round(std::sqrt(1 - s.squaredNorm())));
    normals.push_back(n.head<2>() / n.norm());
  }
  return normals;
}

/// What an 8-bit PNG holds, less the third coordinate.
std::vector<Eigen::Vector2d> stored(const Surface& surface) {
  std::vector<Eigen::Vector2d> normals;
  for (const Eigen::Vector2d& s : surface.normals())
    normals.emplace_back(((s.array() + 1) / kStep).round() * kStep - 1);
  return normals;
}

Surface with_normals(const Surface& surface, std::vector<Eigen::Vector2d> normals) {
  Surface other(surface.width(), surface.height(), surface.interpolation(), std::move(normals));
  other.note_steps({kStep, false, false, kStep});
  return other;
}

/// Adds the P-NDF under a Gaussian footprint of 24 texels about a texel to a picture of the disk's square, up
/// to a factor: half vectors lie a roughness apart, at which a sum of Gaussians is an integral.
std::vector<double> painted(const Surface& surface, const Eigen::Vector2d& center, double roughness) {
  constexpr double sigma = 24, reach = 3 * sigma;
  constexpr int lobe = 4;  // roughnesses that a Gaussian is painted to
  const int side = 2 * static_cast<int>(std::ceil(1 / roughness) + lobe) + 1;
  const int parts = surface.interpolation() == Interpolation::nearest ? 1 : 3;
  std::vector<double> picture(static_cast<std::size_t>(side) * side, 0.0);
  for (double y = -reach + 0.5 / parts; y < reach; y += 1.0 / parts)
    for (double x = -reach + 0.5 / parts; x < reach; x += 1.0 / parts) {
      const Eigen::Vector2d s = normal_at(surface, center + Eigen::Vector2d(x, y)) / roughness;
      const Eigen::Vector2d middle = s.array().round();
      double along[2][2 * lobe + 1];
      for (const int axis : {0, 1})
        for (int n = -lobe; n <= lobe; ++n)
          along[axis][n + lobe] = std::exp(-0.5 * std::pow(middle[axis] + n - s[axis], 2));
      const double weight = std::exp(-0.5 * (x * x + y * y) / (sigma * sigma));
      const int i = static_cast<int>(middle.x()) + side / 2 - lobe,
                j = static_cast<int>(middle.y()) + side / 2 - lobe;
      for (int b = 0; b <= 2 * lobe; ++b)
        for (int a = 0; a <= 2 * lobe; ++a)
          picture[static_cast<std::size_t>(j + b) * side + i + a] += weight * along[0][a] * along[1][b];
    }
  return picture;
}

/// Relative L2 of P-NDFs under footprints of 24 texels.
double error_of(const Surface& surface, const Surface& exact, double roughness) {
  double difference = 0, square = 0;
  for (int footprint = 0; footprint < 2; ++footprint) {
    const Eigen::Vector2d center(std::floor(random_unit(77, 0, footprint) * exact.width()),
                                 std::floor(random_unit(77, 1, footprint) * exact.height()));
    const std::vector<double> found = painted(surface, center, roughness),
                              expected = painted(exact, center, roughness);
    for (std::size_t n = 0; n < expected.size(); ++n)
      difference += std::pow(found[n] - expected[n], 2), square += expected[n] * expected[n];
  }
  return std::sqrt(difference / square);
}

struct Errors {
  double as_is, said, restored;
};
Errors errors_of(const Surface& exact, double roughness) {
  const Surface as_is = with_normals(exact, rounded(exact));
  std::vector<Eigen::Vector2d> normals = stored(exact);
  restore_normals(exact.width(), exact.height(), kStep, &normals);
  const Errors errors{error_of(as_is, exact, roughness), precision_error(as_is, roughness),
                      error_of(with_normals(exact, std::move(normals)), exact, roughness)};
  std::printf("roughness %g: as it is %.1f%%, said %.1f%%, restored %.1f%%\n", roughness, 100 * errors.as_is,
              100 * errors.said, 100 * errors.restored);
  return errors;
}

Surface spectrum(double correlation, std::uint64_t seed,
                 Interpolation interpolation = Interpolation::bilinear) {
  return make_surface({"s", SpectrumSurface{128, 0.15, correlation, seed}, interpolation}, nullptr);
}

TEST(Precision, SmoothMapsComeBackFromTheirSteps) {
  const Errors errors = errors_of(spectrum(32, 3), 0.005);
  EXPECT_GT(errors.as_is, 0.02);
  EXPECT_LE(errors.restored, 0.5 * errors.as_is);
}

/// Brushed metal changes by a step over tens of texels along the brushing.
TEST(Precision, WidePlateausComeBackInPart) {
  BrushedSurface brushed;
  brushed.resolution = 512, brushed.seed = 9;
  const Errors errors = errors_of(make_surface({"b", brushed, Interpolation::bilinear}, nullptr), 0.005);
  EXPECT_LE(errors.restored, 0.6 * errors.as_is);
}

/// Between smooth and rough the smoothest map within the steps is none that was rounded: slopes of few steps,
/// under a lobe that does not see the steps.
TEST(Precision, NoMapIsSmoothedBeyondItsOwnSpectrum) {
  const Surface gentle =
      make_surface({"s", SpectrumSurface{128, 0.05, 20, 7}, Interpolation::bilinear}, nullptr);
  for (const Surface& exact : {spectrum(12, 8), gentle}) {
    const Errors errors = errors_of(exact, 0.01);
    EXPECT_LE(errors.restored, 0.9 * errors.as_is);
  }
}

/// Texels that carry more than their step: what is not known is not made up.
TEST(Precision, RoughMapsStayAsTheyAre) {
  const Surface flakes = make_surface({"f", FlakesSurface{128, 12, 0.2, 5}, Interpolation::nearest}, nullptr);
  for (const Surface& exact : {spectrum(4, 3, Interpolation::nearest), flakes}) {
    const Errors errors = errors_of(exact, 0.005);
    EXPECT_LE(errors.restored, 1.05 * errors.as_is);
  }
}

/// Within a factor of 1.5, of which the measure by a few footprints may take another tenth.
TEST(Precision, TheErrorIsSaidWithoutTheExactMap) {
  BrushedSurface brushed;
  brushed.resolution = 256, brushed.seed = 9;
  const Surface along = make_surface({"b", brushed, Interpolation::bilinear}, nullptr);
  for (const Errors& errors :
       {errors_of(spectrum(8, 5), 0.005), errors_of(spectrum(40, 6), 0.004), errors_of(along, 0.005)}) {
    EXPECT_LE(errors.said, 1.65 * errors.as_is);
    EXPECT_GE(errors.said, errors.as_is / 1.65);
  }
}

/// 8 bits have no flat normal: it is half a step away, and a plane does not tell.
TEST(Precision, APlaneIsOffByHalfAStep) {
  const Surface plane(128, 128, Interpolation::bilinear,
                      std::vector<Eigen::Vector2d>(128 * 128, Eigen::Vector2d::Zero()));
  const Errors errors = errors_of(plane, 0.005);
  EXPECT_GT(errors.as_is, 0.5);
  EXPECT_NEAR(errors.said, errors.as_is, 0.1 * errors.as_is);
  EXPECT_LE(errors.restored, 1e-6);
}

TEST(Precision, WithoutStepsNothingIsLost) {
  EXPECT_EQ(precision_error(spectrum(8, 3), 0.001), 0);
}

}  // namespace
}  // namespace mica::host::precision_test
