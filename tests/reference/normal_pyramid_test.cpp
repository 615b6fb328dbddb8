#include "host/reference/normal_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/surface/interpolate.h"

namespace mica::host::reference::normal_pyramid_test {
namespace {

/// Steep steps, so that Catmull-Rom overshoots; sizes that are no multiples of a block.
Surface stepped_surface(Interpolation interpolation) {
  std::vector<Eigen::Vector2d> normals;
  for (int k = 0; k < 37 * 21; ++k) normals.emplace_back(k % 7 < 3 ? -0.5 : 0.5, 0.4 * std::sin(k * k));
  return Surface(37, 21, interpolation, std::move(normals));
}

class NormalPyramidOf : public testing::TestWithParam<Interpolation> {};

TEST_P(NormalPyramidOf, EveryLevelHoldsTheNormalsBelowItAndNoMore) {
  const Surface surface = stepped_surface(GetParam());
  const CellMap map(surface);
  const NormalPyramid pyramid(map);
  ASSERT_EQ(pyramid.columns(pyramid.top_level()), 1);
  ASSERT_EQ(pyramid.rows(pyramid.top_level()), 1);
  for (int level = 0; level <= pyramid.top_level(); ++level) {
    const int cells = CellMap::block_cells << level;
    std::vector<NormalBox> expected(pyramid.columns(level) * pyramid.rows(level));
    for (int j = 0; j < map.rows(); ++j) {
      for (int i = 0; i < map.columns(); ++i) {
        for (int corner = 0; corner < 4;
             ++corner) {  // just inside the cell, where `nearest` is its own texel
          const double inside = 1e-9, x = corner & 1 ? 1 - inside : inside,
                       y = corner >> 1 ? 1 - inside : inside;
          const Eigen::Vector2d position =
              map.corner_texels(i, j) + map.cell_texels() * Eigen::Vector2d(x, y);
          expected[(j / cells) * pyramid.columns(level) + i / cells].include(normal_at(surface, position));
        }
      }
    }
    for (int j = 0; j < pyramid.rows(level); ++j) {
      for (int i = 0; i < pyramid.columns(level); ++i) {
        const NormalBox& box = pyramid.bounds(level, i, j);
        const NormalBox& sampled = expected[j * pyramid.columns(level) + i];
        EXPECT_LT((box.low - sampled.low).cwiseAbs().maxCoeff(), 1e-8) << level << ' ' << i << ' ' << j;
        EXPECT_LT((box.high - sampled.high).cwiseAbs().maxCoeff(), 1e-8) << level << ' ' << i << ' ' << j;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, NormalPyramidOf,
                         testing::Values(Interpolation::nearest, Interpolation::bilinear,
                                         Interpolation::bicubic));

}  // namespace
}  // namespace mica::host::reference::normal_pyramid_test
