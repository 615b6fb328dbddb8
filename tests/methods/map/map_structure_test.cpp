#include "host/methods/map/map_structure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/surface/interpolate.h"

namespace mica::host::map_structure_test {
namespace {

using namespace device_types;

Surface spectrum(int resolution, Interpolation interpolation) {
  SurfaceDescription description;
  SpectrumSurface source;
  source.resolution = resolution;
  source.rms_slope = 0.4;
  source.correlation_texels = 3;
  description.source = source;
  description.interpolation = interpolation;
  return make_surface(description, nullptr);
}

/// A map whose size is no multiple of anything in the structure.
Surface odd(Interpolation interpolation) {
  constexpr int width = 71, height = 45;
  std::vector<Eigen::Vector2d> normals;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      normals.push_back({0.9 * std::sin(0.7 * i + j), 0.3 * std::cos(1.3 * j * i)});
  return Surface(width, height, interpolation, normals);
}

struct Bounds {
  double s_min, s_max, t_min, t_max;
};
Bounds child_bounds(const std::int16_t* node, int child) {
  const double one = MICA_BOUND_ONE;
  return {node[child] / one, node[child + 16] / one, node[child + 32] / one, node[child + 48] / one};
}

class MapStructureTest : public testing::TestWithParam<Interpolation> {};

// Every point of the surface lies in the bounds of its leaf and of its tile.
TEST_P(MapStructureTest, BoundsHoldTheInterpolatedSurface) {
  const bool nearest = GetParam() == Interpolation::nearest;
  for (const Surface& surface : {spectrum(64, GetParam()), odd(GetParam())}) {
    const MapStructure map = build_map_structure(surface);
    const double slack = 2.0 / MICA_NORMAL_ONE;  // normals are rounded before they are bounded
    for (int step = 0; step < 60000; ++step) {
      // Additive recurrence: well spread points of the period, in the coordinates of quads.
      const double x = std::fmod(0.7548776662466927 * step, 1.0) * surface.width();
      const double y = std::fmod(0.5698402909980532 * step, 1.0) * surface.height();
      const Eigen::Vector2d centre = nearest ? Eigen::Vector2d(x, y) : Eigen::Vector2d(x + 0.5, y + 0.5);
      const Eigen::Vector2d normal = normal_at(surface, centre);
      const int i = static_cast<int>(x), j = static_cast<int>(y);
      const int block = (j / MICA_BLOCK) * map.grid.blocks_x + i / MICA_BLOCK;
      const int tile = (j % MICA_BLOCK) / MICA_TILE * 4 + (i % MICA_BLOCK) / MICA_TILE;
      const int leaf = (j % MICA_TILE) / MICA_LEAF * 4 + (i % MICA_TILE) / MICA_LEAF;
      for (const Bounds& b : {child_bounds(&map.block_nodes[block * MICA_NODE_STRIDE], tile),
                              child_bounds(&map.tile_nodes[(block * 16 + tile) * MICA_NODE_STRIDE], leaf)}) {
        ASSERT_LE(b.s_min, normal.x() + slack) << i << ' ' << j;
        ASSERT_GE(b.s_max, normal.x() - slack) << i << ' ' << j;
        ASSERT_LE(b.t_min, normal.y() + slack) << i << ' ' << j;
        ASSERT_GE(b.t_max, normal.y() - slack) << i << ' ' << j;
      }
    }
  }
}

// Bounds that hold everything would pass the test above: these are tight to their rounding.
TEST(MapStructure, BilinearBoundsAreTight) {
  const Surface surface = spectrum(64, Interpolation::bilinear);
  const MapStructure map = build_map_structure(surface);
  for (int leaf = 0; leaf < 16; ++leaf) {
    double s_min = 1, s_max = -1;
    for (int j = 0; j <= 4; ++j) {
      for (int i = 0; i <= 4; ++i) {
        const double s = surface.texel((leaf & 3) * 4 + i, (leaf >> 2) * 4 + j).x();
        s_min = std::min(s_min, s), s_max = std::max(s_max, s);
      }
    }
    const Bounds b = child_bounds(map.tile_nodes.data(), leaf);
    EXPECT_NEAR(b.s_min, s_min, 1.01 / MICA_BOUND_ONE);
    EXPECT_NEAR(b.s_max, s_max, 1.01 / MICA_BOUND_ONE);
  }
}

TEST_P(MapStructureTest, StoresEveryTexelWithItsApron) {
  const Surface surface = odd(GetParam());
  const MapStructure map = build_map_structure(surface);
  for (int block = 0; block < map.grid.blocks_x * map.grid.blocks_y; ++block) {
    const int first_i = block % map.grid.blocks_x * MICA_BLOCK,
              first_j = block / map.grid.blocks_x * MICA_BLOCK;
    for (int row = 0; row < MICA_BLOCK_ROW; ++row) {
      for (int column = 0; column < MICA_BLOCK_ROW; ++column) {
        const Eigen::Vector2d& normal = surface.texel(first_i + column - 1, first_j + row - 1);
        const std::int32_t* stored = &map.normals[block * MICA_BLOCK_STRIDE + row * MICA_BLOCK_ROW + column];
        ASSERT_NEAR(stored[0], normal.x() * MICA_NORMAL_ONE, 0.51);
        ASSERT_NEAR(stored[MICA_BLOCK_PLANE], normal.y() * MICA_NORMAL_ONE, 0.51);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Interpolations, MapStructureTest,
                         testing::Values(Interpolation::nearest, Interpolation::bilinear,
                                         Interpolation::bicubic));

TEST(MapStructure, TakesFortyMebibytesAtMostForA2048Map) {
  EXPECT_LE(map_structure_bytes(2048, 2048), std::size_t{40} << 20);
  const Surface surface = spectrum(128, Interpolation::bilinear);
  EXPECT_EQ(build_map_structure(surface).bytes(), map_structure_bytes(128, 128));
}

}  // namespace
}  // namespace mica::host::map_structure_test
