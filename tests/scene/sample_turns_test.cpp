#include "host/scene/sample_turns.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mica::host::sample_turns_test {
namespace {

/// Samples of a pixel of n x n, whose normals make these cosines with the eye.
std::vector<SeenPoint> points_of(const std::vector<double>& cosines) {
  std::vector<SeenPoint> points(cosines.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    points[k].hit.emplace();
    points[k].hit->shape = 0, points[k].hit->part = 0;
    points[k].faces_eye = true;
    points[k].to_eye = {0, 0, 1};
    points[k].frame.z = {std::sqrt(1 - cosines[k] * cosines[k]), 0, cosines[k]};
  }
  return points;
}

TEST(MissedByBend, IsHalfOfWhatTheCosineChangesByOverTheFootprint) {
  const std::vector<double> flat(4, 0.7);
  EXPECT_EQ(missed_by_bend(points_of(flat), 2, 0, 0.25), 0);
  // 0.02 to the right and 0.04 down within half a pixel, of 0.5.
  const double missed = missed_by_bend(points_of({0.5, 0.52, 0.46, 0.48}), 2, 0, 0.25);
  EXPECT_NEAR(missed, 0.5 * 0.25 * std::hypot(0.02, 0.04) / 0.5 / 0.5, 1e-12);
  EXPECT_EQ(missed_by_bend(points_of({0.01, 0.9, 0.9, 0.9}), 2, 0, 0.25), 1);
}

TEST(MissedByBend, IsAllWhereTheSurfaceEndsBesideTheSample) {
  std::vector<SeenPoint> points = points_of(std::vector<double>(4, 0.7));
  points[1].hit.reset();
  EXPECT_EQ(missed_by_bend(points, 2, 0, 0.25), 1);
  EXPECT_EQ(missed_by_bend(points, 2, 3, 0.25), 1);
  EXPECT_EQ(missed_by_bend(points, 2, 2, 0.25), 0) << "not beside it";
  points[1] = points[0];
  points[1].hit->part = 1;
  EXPECT_EQ(missed_by_bend(points, 2, 0, 0.25), 1);
}

TEST(LightsBeside, AreThoseThatASampleBesideSees) {
  std::vector<SeenPoint> points = points_of(std::vector<double>(4, 0.7));
  SeenLamp& lamp = points[1].lamps.emplace_back();
  lamp.light = 1, lamp.is_above = true, lamp.visible = 1;
  const std::vector<bool> none(3, false), second = {false, true, false};
  EXPECT_EQ(lights_beside(points, 2, 0, 3), second);
  EXPECT_EQ(lights_beside(points, 2, 3, 3), second);
  EXPECT_EQ(lights_beside(points, 2, 2, 3), none);
  EXPECT_EQ(lights_beside(points, 2, 1, 3), none) << "its own do not count";
  lamp.visible = 0;
  EXPECT_EQ(lights_beside(points, 2, 0, 3), none);
}

}  // namespace
}  // namespace mica::host::sample_turns_test
