// What a pixel's Gaussian leaves out, against sums over the plane of what bends.
#include "host/scene/second_order.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "host/base/random.h"

namespace mica::host::second_order_test {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Symmetric matrices of about `size`; the n-th of some that are the same in every run.
SecondOrder random_bend(std::uint64_t n, double of_uv, double of_h) {
  std::uint64_t draws = 0;
  const auto random = [&](double size) { return size * (2 * random_unit(n, 0x62656e64, draws++) - 1); };
  const auto symmetric = [&](double size) {
    Matrix2d matrix;
    matrix << random(size), random(size), 0, random(size);
    matrix(1, 0) = matrix(0, 1);
    return matrix;
  };
  return {{symmetric(of_uv), symmetric(of_uv)}, {symmetric(of_h), symmetric(of_h)}, Matrix2d::Zero()};
}

template <typename Visit>
void over_the_plane(const Visit& visit) {
  constexpr double step = 0.05, end = 5;
  for (double y = -end; y < end; y += step)
    for (double x = -end; x < end; x += step) visit(Vector2d(x, y));
}

double gaussian(const Vector2d& y) {
  return std::exp(-0.5 * y.squaredNorm());
}

/// Density at u of a Gaussian over y of weight exp(a y), where u = y + q(y, y) / 2.
double bent_density(const SecondOrder& bend, const Vector2d& a, const Vector2d& u) {
  Vector2d y = u;
  Matrix2d slope;
  for (int step = 0; step < 8; ++step) {
    const Vector2d q(y.dot(bend.of_uv[0] * y), y.dot(bend.of_uv[1] * y));
    slope = Matrix2d::Identity();
    slope.row(0) += (bend.of_uv[0] * y).transpose(), slope.row(1) += (bend.of_uv[1] * y).transpose();
    y -= slope.inverse() * (y + 0.5 * q - u);
  }
  return gaussian(y) * std::exp(a.dot(y)) / std::abs(slope.determinant());
}

double distance(const SecondOrder& bend, const Vector2d& a, const Vector2d& shift) {
  double square = 0, all = 0;
  over_the_plane([&](const Vector2d& u) {
    const double truth = bent_density(bend, a, u),
                 one = gaussian(u - shift) * std::exp(0.5 * a.squaredNorm());
    square += (truth - one) * (truth - one), all += truth * truth;
  });
  return std::sqrt(square / all);
}

TEST(SecondOrder, ABentFootprintIsAsFarFromItsGaussianAsIsSaid) {
  for (std::uint64_t n = 0; n < 12; ++n) {
    const SecondOrder bend = random_bend(n, 0.02, 0);
    EXPECT_NEAR(distance(bend, {0, 0}, best_shift(bend, {0, 0})),
                std::sqrt(left_out(bend, Matrix2d::Identity()).trace()),
                0.1 * std::sqrt(left_out(bend, Matrix2d::Identity()).trace()))
        << n;
  }
}

TEST(SecondOrder, NoOtherShiftIsNearer) {
  const Vector2d slope(0.02, -0.01);
  for (std::uint64_t n = 0; n < 4; ++n) {
    const SecondOrder bend = random_bend(n, 0.02, 0);
    const Vector2d best = best_shift(bend, slope);
    const double least = distance(bend, slope, best);
    for (const Vector2d& other :
         {Vector2d(0.005, 0), Vector2d(-0.005, 0), Vector2d(0, 0.005), Vector2d(0, -0.005)})
      EXPECT_GT(distance(bend, slope, best + other), least) << n;
  }
}

/// Glints of any place and normal: two lobes d standard deviations apart differ by 2 (1 - exp(-d^2 / 4)) of
/// their square.
TEST(SecondOrder, HalfVectorsThatBendMissByAsMuchAsIsSaid) {
  constexpr double roughness = 0.01;
  for (std::uint64_t n = 0; n < 12; ++n) {
    const SecondOrder bend = random_bend(n, 0, 0.1 * roughness);
    double square = 0, all = 0;
    over_the_plane([&](const Vector2d& y) {
      const double weight = gaussian(y) * gaussian(y);
      double missed2 = 0;
      for (const Matrix2d& h : bend.of_h)
        missed2 += std::pow((0.5 * y.dot(h * y) - 0.25 * h.trace()) / roughness, 2);
      square += weight * 2 * (1 - std::exp(-missed2 / 4)), all += weight;
    });
    const double said = std::sqrt(left_out(bend, roughness * roughness * Matrix2d::Identity()).trace());
    EXPECT_NEAR(std::sqrt(square / all), said, 0.02 * said) << n;
  }
}

/// A factor exp(y' W y / 2) of which the footprint has the mean.
TEST(SecondOrder, WhatTheLightsFactorBendsIsAsMuchAsIsSaid) {
  for (std::uint64_t n = 0; n < 12; ++n) {
    SecondOrder bend = random_bend(n, 0, 0);
    bend.of_log_weight = random_bend(n, 0, 0.05).of_h[0];
    double square = 0, all = 0;
    over_the_plane([&](const Vector2d& y) {
      const double weight = gaussian(y) * gaussian(y);
      const double factor = std::exp(0.5 * y.dot(bend.of_log_weight * y) - 0.25 * bend.of_log_weight.trace());
      square += weight * (factor - 1) * (factor - 1), all += weight;
    });
    const double said = std::sqrt(left_out(bend, Matrix2d::Identity()).trace());
    EXPECT_NEAR(std::sqrt(square / all), said, 0.05 * said) << n;
  }
}

/// The direction in which most is left is the one that bends.
TEST(SecondOrder, TellsTheDirection) {
  SecondOrder bend = random_bend(0, 0, 0);
  bend.of_uv[1](1, 1) = 0.1;
  EXPECT_GT(left_out(bend, Matrix2d::Identity())(1, 1), 0);
  EXPECT_EQ(left_out(bend, Matrix2d::Identity())(0, 0), 0);
  bend = random_bend(0, 0, 0);
  bend.of_h[1](0, 0) = 0.1;
  EXPECT_GT(left_out(bend, Matrix2d::Identity())(0, 0), 0);
  EXPECT_EQ(left_out(bend, Matrix2d::Identity())(1, 1), 0);
}

}  // namespace
}  // namespace mica::host::second_order_test
