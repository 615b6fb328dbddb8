#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host/scene/coat_crossing.h"

namespace mica::host::coat_crossing_test {
namespace {

Eigen::Vector3d direction(double z, double azimuth) {
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
}

LayeredMaterial coated(double ior) {
  MaterialDescription material;
  material.coat = CoatDescription{ior, 0.02};
  return {material, 0.1};
}

TEST(CoatCrossing, AboveUndoesBelow) {
  const LayeredMaterial coat = coated(1.5);
  const CoatCrossing crossing(coat, direction(0.6, 1));
  for (const double z : {0.01, 0.3, 0.99}) {
    const Eigen::Vector3d light = direction(z, 2);
    EXPECT_LT((crossing.above(crossing.below(light)) - light).norm(), 1e-12) << z;
  }
  // Beyond the critical angle of 41.8 degrees nothing crosses.
  EXPECT_LT(crossing.above(direction(std::cos(0.731), 1)).z(), 0);
  EXPECT_GT(crossing.above(direction(std::cos(0.728), 1)).z(), 0);
}

TEST(CoatCrossing, DensityScaleIsTheRatioOfSolidAngles) {
  const LayeredMaterial coat = coated(1.33);
  const CoatCrossing crossing(coat, direction(0.6, 1));
  for (const double z : {0.1, 0.5, 0.9}) {
    // Rings between z -+ h, of area 2 pi times the difference of their cosines.
    const double h = 1e-4;
    const double below = crossing.below(direction(z + h, 0)).z() - crossing.below(direction(z - h, 0)).z();
    EXPECT_NEAR(crossing.density_scale(direction(z, 0)), below / (2 * h), 1e-6) << z;
  }
}

TEST(CoatCrossing, WithoutACoatNothingChanges) {
  const LayeredMaterial none(MaterialDescription{}, 0.1);
  const Eigen::Vector3d view = direction(0.6, 1), light = direction(0.2, 4);
  const CoatCrossing crossing(none, view);
  EXPECT_EQ(crossing.view_below(), view);
  EXPECT_EQ(crossing.below(light), light);
  EXPECT_EQ(crossing.above(light), light);
  EXPECT_EQ(crossing.value_scale(light), Color::Ones());
  EXPECT_EQ(crossing.density_scale(light), 1);
}

}  // namespace
}  // namespace mica::host::coat_crossing_test
