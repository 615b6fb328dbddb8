// What 8 bits cost a P-NDF, and what comes back: against the float maps that the integers came from.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "host/base/error_norms.h"
#include "host/base/random.h"
#include "host/reference/oracle.h"
#include "host/surface/map_precision.h"
#include "host/surface/texel_footprint.h"

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

Surface with_normals(const Surface& surface, std::vector<Eigen::Vector2d> normals) {
  Surface other(surface.width(), surface.height(), surface.interpolation(), std::move(normals));
  other.note_steps({kStep, false});
  return other;
}

/// Relative L2 of P-NDFs under footprints of 24 texels, over half vectors all around the normals there.
double error_of(const Surface& surface, const Surface& exact, double roughness) {
  std::vector<Query> queries;
  for (int footprint = 0; footprint < 3; ++footprint)
    for (int n = 0; n < 160; ++n) {
      const auto random = [&](std::uint64_t stream) { return random_unit(footprint, stream, n); };
      const Eigen::Vector2d center(random_unit(77, 0, footprint), random_unit(77, 1, footprint));
      const long i = std::lround(center.x() * exact.width() + 30 * (random(0) + random(1) - 1)),
                 j = std::lround(center.y() * exact.height() + 30 * (random(2) + random(3) - 1));
      const Eigen::Vector2d off(random(4) - 0.5, random(5) - 0.5);
      queries.push_back(
          {make_footprint(exact, center, 24, 24, 0), exact.texel(i, j) + 4 * roughness * off, roughness});
    }
  const reference::Oracle found(surface, 1e-3), expected(exact, 1e-3);
  std::vector<float> densities;
  std::vector<double> reference;
  for (const reference::OracleResult& result : found.evaluate(queries))
    densities.push_back(static_cast<float>(result.density));
  for (const reference::OracleResult& result : expected.evaluate(queries))
    reference.push_back(result.density);
  return relative_l2(densities, reference);
}

struct Errors {
  double as_is, said, restored;
};
Errors errors_of(const Surface& exact, double roughness) {
  const Surface as_is = with_normals(exact, rounded(exact));
  std::vector<Eigen::Vector2d> normals = as_is.normals();
  restore_normals(exact.width(), exact.height(), kStep, &normals);
  const Errors errors{error_of(as_is, exact, roughness), precision_error(as_is, roughness),
                      error_of(with_normals(exact, std::move(normals)), exact, roughness)};
  std::printf("roughness %g: as it is %.1f%%, said %.1f%%, restored %.1f%%\n", roughness, 100 * errors.as_is,
              100 * errors.said, 100 * errors.restored);
  return errors;
}

Surface spectrum(double correlation, std::uint64_t seed) {
  return make_surface({"s", SpectrumSurface{128, 0.15, correlation, seed}, Interpolation::bilinear}, nullptr);
}

TEST(Precision, SmoothMapsComeBackFromTheirSteps) {
  const Errors errors = errors_of(spectrum(32, 3), 0.005);
  EXPECT_GT(errors.as_is, 0.02);
  EXPECT_LE(errors.restored, 0.5 * errors.as_is);
}

/// Texels that carry more than their step: what is not known is not made up.
TEST(Precision, RoughMapsStayAsTheyAre) {
  const Surface flakes = make_surface({"f", FlakesSurface{128, 12, 0.2, 5}, Interpolation::nearest}, nullptr);
  for (const Surface& exact : {spectrum(4, 3), flakes}) {
    const Errors errors = errors_of(exact, 0.005);
    EXPECT_LE(errors.restored, 1.05 * errors.as_is);
  }
}

/// Within a factor of 1.5, of which the measure by a few footprints may take another tenth.
TEST(Precision, TheErrorIsSaidWithoutTheExactMap) {
  for (const Errors& errors : {errors_of(spectrum(8, 5), 0.005), errors_of(spectrum(40, 6), 0.004)}) {
    EXPECT_LE(errors.said, 1.65 * errors.as_is);
    EXPECT_GE(errors.said, errors.as_is / 1.65);
  }
}

TEST(Precision, WithoutStepsNothingIsLost) {
  EXPECT_EQ(precision_error(spectrum(8, 3), 0.001), 0);
}

}  // namespace
}  // namespace mica::host::precision_test
