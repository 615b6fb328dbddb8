#include "host/methods/map/map_query.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mica::host::map_query_test {
namespace {

Footprint footprint(double sigma_major, double sigma_minor, double angle, int width, int height) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
  const Eigen::Vector2d variances(sigma_major * sigma_major, sigma_minor * sigma_minor);
  const Eigen::Matrix2d texels = turn * variances.asDiagonal() * turn.transpose();
  const Eigen::Vector2d to_uv(1.0 / width, 1.0 / height);
  Footprint result;
  result.cov_uv = to_uv.asDiagonal() * texels * to_uv.asDiagonal();
  return result;
}

TEST(FootprintAxes, FindsTheStandardDeviationsOfThinEllipses) {
  for (const double aspect : {1.0, 1.5, 100.0, 1e4}) {
    for (double angle = -3; angle <= 3; angle += 0.37) {
      const FootprintAxes axes = footprint_axes(footprint(20, 20 / aspect, angle, 64, 256), 64, 256);
      EXPECT_NEAR(axes.sigma_major_texels, 20, 1e-9);
      // The covariance matrix itself holds the small variance to 1e-16 of the large one.
      EXPECT_NEAR(axes.sigma_minor_texels * aspect, 20, 1e-14 * aspect * aspect * 20 + 1e-9);
      EXPECT_NEAR(axes.major.dot(axes.minor), 0, 1e-15);
      if (aspect > 1.2) {
        EXPECT_NEAR(std::abs(axes.major.dot(Eigen::Vector2d(std::cos(angle), std::sin(angle)))), 1, 1e-9);
      }
    }
  }
}

TEST(ToMapQuery, WhitensTheCovariance) {
  Query query;
  query.footprint = footprint(12, 3, 0.7, 128, 32);
  const auto m = to_map_query(query, {128, 32, 2, 1}, Interpolation::bilinear, 32);
  Eigen::Matrix2d whiten;
  whiten << m.whiten_1x, m.whiten_1y, m.whiten_2x, m.whiten_2y;
  const Eigen::Matrix2d texels =
      Eigen::Vector2d(128, 32).asDiagonal() * query.footprint.cov_uv * Eigen::Vector2d(128, 32).asDiagonal();
  EXPECT_LT((whiten * texels * whiten.transpose() - Eigen::Matrix2d::Identity()).norm(), 1e-5);
}

TEST(ToMapQuery, WrapsFarCoordinatesWithoutLosingTheTexel) {
  Query near, far;
  near.footprint = far.footprint = footprint(2, 1, 0, 2048, 2048);
  near.footprint.mean_uv = {0.3125, 0.75};
  far.footprint.mean_uv = {1e7 + 0.3125, -1e7 + 0.75};
  for (const Interpolation interpolation : {Interpolation::nearest, Interpolation::bilinear}) {
    const auto a = to_map_query(near, {2048, 2048, 32, 32}, interpolation, 32);
    const auto b = to_map_query(far, {2048, 2048, 32, 32}, interpolation, 32);
    EXPECT_EQ(a.mean_i, b.mean_i);
    EXPECT_EQ(a.mean_j, b.mean_j);
    EXPECT_NEAR(a.mean_x, b.mean_x, 1e-5);
    EXPECT_NEAR(a.mean_y, b.mean_y, 1e-5);
    EXPECT_GE(a.mean_i, 0);
    EXPECT_LT(a.mean_i, 2048);
  }
}

TEST(ToMapQuery, PutsTheFirstTexelCentreAtQuadZero) {
  Query query;
  query.footprint = footprint(2, 1, 0, 64, 64);
  query.footprint.mean_uv = {0.5 / 64, 0.25 / 64};
  const auto m = to_map_query(query, {64, 64, 1, 1}, Interpolation::bilinear, 32);
  EXPECT_EQ(m.mean_i, 0);
  EXPECT_FLOAT_EQ(m.mean_x, 0.0f);
  EXPECT_EQ(m.mean_j, 63);  // a quarter of a texel below the first centre: the quad across the wrap
  EXPECT_FLOAT_EQ(m.mean_y, 0.75f);
}

TEST(QueryProblem, NamesWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Query good;
  good.footprint = footprint(2, 1, 0.3, 64, 64);
  EXPECT_EQ(query_problem(good, 64, 64), "");
  const auto problem = [&](auto change) {
    Query query = good;
    change(query);
    return query_problem(query, 64, 64);
  };
  EXPECT_EQ(problem([&](Query& q) { q.footprint.mean_uv.x() = nan; }), "uv is not finite");
  EXPECT_EQ(problem([&](Query& q) { q.footprint.cov_uv(0, 1) = nan; }), "covariance is not finite");
  EXPECT_EQ(problem([&](Query& q) { q.half_vector.y() = INFINITY; }), "half vector is not finite");
  EXPECT_EQ(problem([&](Query& q) { q.footprint.cov_uv(1, 1) = -1; }), "covariance is not positive definite");
  EXPECT_EQ(problem([&](Query& q) { q.footprint.cov_uv << 1, 1, 1, 1; }),
            "covariance is not positive definite");
  EXPECT_NE(problem([&](Query& q) { q.roughness = 0; }).find("roughness 0"), std::string::npos);
  EXPECT_NE(problem([&](Query& q) { q.roughness = nan; }).find("roughness"), std::string::npos);
  EXPECT_NE(problem([&](Query& q) { q.half_vector.x() = 1.5; }).find("half vector (1.5"), std::string::npos);
  EXPECT_NE(problem([&](Query& q) { q.footprint.cov_uv *= 1e12; }).find("texels"), std::string::npos);
}

}  // namespace
}  // namespace mica::host::map_query_test
