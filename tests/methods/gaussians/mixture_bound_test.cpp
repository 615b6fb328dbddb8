// The bounds of a mixture's hierarchy: they hold for every element, and see a tilted plane.
#include "host/methods/gaussians/mixture_bound.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "host/base/random.h"
#include "kernels/types.h"

namespace mica::host::mixture_bound_test {
namespace {

using device_types::MICA_MIXTURE_NODE_STRIDE;

constexpr int kChild = 5;
constexpr BoundUnits kUnits{1.0 / 32767, 2.0 / 32767};

/// What a node says of a child.
struct Bound {
  Eigen::Vector2d axis, normal, low, high, spread;
};

Bound bound_of(const std::vector<ElementMoments>& elements) {
  std::array<std::int16_t, MICA_MIXTURE_NODE_STRIDE> node{};
  store_bound(elements, kUnits, kChild, node.data());
  const auto number = [&](int n) { return static_cast<double>(node[16 * n + kChild]); };
  Bound bound;
  bound.axis = Eigen::Vector2d(number(0), number(1)) / 32767;
  bound.normal = {-bound.axis.y(), bound.axis.x()};
  bound.low = Eigen::Vector2d(number(2), number(4)) * kUnits.mean;
  bound.high = Eigen::Vector2d(number(3), number(5)) * kUnits.mean;
  bound.spread = Eigen::Vector2d(number(6), number(7)) * kUnits.spread;
  return bound;
}

double random(std::uint64_t set, std::uint64_t n) {
  return random_unit(3, set, n);
}

TEST(MixtureBound, HoldsForEveryElement) {
  for (int set = 0; set < 200; ++set) {
    std::vector<ElementMoments> elements;
    const double thin = std::pow(0.01, random(set, 1000));
    for (int n = 0; n < 16; ++n) {
      const double x = 0.2 * random(set, 8 * n), y = thin * 0.2 * random(set, 8 * n + 1),
                   turned = random(set, 8 * n + 2);
      ElementMoments element;
      element.mean = {0.7 * random(set, 8 * n + 3) - 0.4, 0.5 * random(set, 8 * n + 4)};
      element.xx = std::pow(x * std::cos(turned), 2) + std::pow(y * std::sin(turned), 2);
      element.xy = (x * x - y * y) * std::cos(turned) * std::sin(turned);
      element.yy = std::pow(x * std::sin(turned), 2) + std::pow(y * std::cos(turned), 2);
      elements.push_back(element);
    }
    const Bound bound = bound_of(elements);
    EXPECT_NEAR(bound.axis.norm(), 1, 3e-5);
    for (const ElementMoments& element : elements) {
      const Eigen::Vector2d place(bound.axis.dot(element.mean), bound.normal.dot(element.mean));
      EXPECT_TRUE((place.array() >= bound.low.array()).all() && (place.array() <= bound.high.array()).all());
      for (int k = 0; k < 32; ++k) {  // d^T C d, along any d
        const Eigen::Vector2d d(std::cos(M_PI * k / 32), std::sin(M_PI * k / 32));
        const Eigen::Vector2d by_axis(bound.axis.dot(d), bound.normal.dot(d));
        EXPECT_LE(element.xx * d.x() * d.x() + 2 * element.xy * d.x() * d.y() + element.yy * d.y() * d.y(),
                  by_axis.cwiseProduct(bound.spread).squaredNorm());
      }
    }
  }
}

/// Elements of a bent sheet, whose normals run along one oblique line: there is nothing beside it.
TEST(MixtureBound, SeesATiltedPlane) {
  const Eigen::Vector2d line(0.6, -0.8);
  std::vector<ElementMoments> elements;
  for (int n = 0; n < 16; ++n) {
    const double variance = 1e-4;
    elements.push_back({0.02 * n * line, variance * line.x() * line.x(), variance * line.x() * line.y(),
                        variance * line.y() * line.y()});
  }
  const Bound bound = bound_of(elements);
  EXPECT_NEAR(std::abs(bound.axis.dot(line)), 1, 1e-4);
  EXPECT_NEAR(bound.high.x() - bound.low.x(), 0.3, 1e-4);
  EXPECT_LT(bound.high.y() - bound.low.y(), 1e-4);
  EXPECT_NEAR(bound.spread.x(), 0.01, 1e-4);
  EXPECT_LT(bound.spread.y(), 4e-4);  // the axis' own 16 bits
}

TEST(MixtureBound, OfNoElementsIsEmpty) {
  const Bound bound = bound_of({});
  EXPECT_GT(bound.low.x(), bound.high.x());
}

}  // namespace
}  // namespace mica::host::mixture_bound_test
