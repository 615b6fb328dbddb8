#include "host/methods/beckmanns/lobes.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "host/methods/beckmanns/lobe_moments.h"
#include "host/methods/gaussians/mixture.h"
#include "host/methods/gaussians/mixture_bound.h"
#include "mica/error.h"

namespace mica::host {
namespace {

using namespace device_types;

constexpr int kChildren = 16;
constexpr std::size_t kLeavesABlock = kChildren * kChildren;

int blocks(int elements) {
  return (elements + MICA_BLOCK - 1) / MICA_BLOCK;
}

/// The four floats behind a leaf's numbers.
struct LeafFrame {
  float mean_x = 0, mean_y = 0;          // of which the means are differences
  float mean_unit = 0, spread_unit = 0;  // of the numbers
};

std::int16_t to_units(double value, double unit) {
  if (unit == 0) return 0;
  return static_cast<std::int16_t>(std::clamp<double>(std::round(value / unit), -kLargest16, kLargest16));
}

using Leaf = std::array<Lobe, kChildren>;

/// @param present bits of the lobes that the map has.
void store_leaf(const Leaf& leaf, unsigned present, std::int16_t* at) {
  Eigen::Array2d low = Eigen::Array2d::Constant(INFINITY), high = -low;
  double spread = 0;
  for (int n = 0; n < kChildren; ++n) {
    if (!((present >> n) & 1)) continue;
    low = low.min(leaf[n].mean.array()), high = high.max(leaf[n].mean.array());
    spread = std::max({spread, leaf[n].spread_xx, std::abs(leaf[n].spread_yx), leaf[n].spread_yy});
  }
  LeafFrame frame;
  if (present) {
    frame.mean_x = static_cast<float>(0.5 * (low.x() + high.x()));
    frame.mean_y = static_cast<float>(0.5 * (low.y() + high.y()));
    const double reach = std::max(
        {high.x() - frame.mean_x, frame.mean_x - low.x(), high.y() - frame.mean_y, frame.mean_y - low.y()});
    frame.mean_unit = static_cast<float>(reach / kLargest16);
    frame.spread_unit = static_cast<float>(spread / kLargest16);
  }
  for (int n = 0; n < kChildren; ++n) {
    if (!((present >> n) & 1)) continue;
    at[n] = to_units(leaf[n].mean.x() - frame.mean_x, frame.mean_unit);
    at[n + 16] = to_units(leaf[n].mean.y() - frame.mean_y, frame.mean_unit);
    at[n + 32] = to_units(leaf[n].spread_xx, frame.spread_unit);
    at[n + 48] = to_units(leaf[n].spread_yx, frame.spread_unit);
    at[n + 64] = to_units(leaf[n].spread_yy, frame.spread_unit);
  }
  static_assert(sizeof(LeafFrame) == (MICA_LOBE_LEAF - 80) * sizeof(std::int16_t));
  std::memcpy(at + 80, &frame, sizeof frame);
}

Lobe load_lobe(const std::int16_t* leaf, int n) {
  LeafFrame frame;
  std::memcpy(static_cast<void*>(&frame), leaf + 80, sizeof frame);
  Lobe lobe;
  lobe.mean = {frame.mean_x + static_cast<double>(frame.mean_unit) * leaf[n],
               frame.mean_y + static_cast<double>(frame.mean_unit) * leaf[n + 16]};
  const double unit = frame.spread_unit;
  lobe.spread_xx = unit * leaf[n + 32], lobe.spread_yx = unit * leaf[n + 48],
  lobe.spread_yy = unit * leaf[n + 64];
  return lobe;
}

/// Of slopes: B S B.
ElementMoments slope_moments_of(const Lobe& lobe) {
  const Eigen::Vector2d& p = lobe.mean;
  const double root_w = std::sqrt(1 + p.squaredNorm());
  const auto stretched = [&](const Eigen::Vector2d& d) {
    return Eigen::Vector2d(root_w * (d + p.dot(d) * p));
  };
  const Eigen::Vector2d x = stretched({lobe.spread_xx, lobe.spread_yx}), y = stretched({0, lobe.spread_yy});
  return {p, x.x() * x.x() + y.x() * y.x(), x.x() * x.y() + y.x() * y.y(), x.y() * x.y() + y.y() * y.y()};
}

/// Largest slope and standard deviation of some lobes.
struct LobeRange {
  double slope = 0, spread = 0;

  void add(const LobeRange& other) {
    slope = std::max(slope, other.slope), spread = std::max(spread, other.spread);
  }
  void add(const ElementMoments& lobe) {
    const double largest = 0.5 * (lobe.xx + lobe.yy + std::hypot(lobe.xx - lobe.yy, 2 * lobe.xy));
    add(LobeRange{lobe.mean.norm(), std::sqrt(largest)});
  }
};

/// Lobes of one block, leaf by leaf.
void store_block(const Surface& surface, int elements, int block_x, int block_y, const mica_map_grid& grid,
                 std::int16_t* block) {
  const std::vector<SlopeMoments> moments =
      slope_moments(surface, elements, block_x * MICA_BLOCK, block_y * MICA_BLOCK, MICA_BLOCK);
  for (std::size_t n = 0; n < kLeavesABlock; ++n) {
    const int tile = static_cast<int>(n / kChildren), child = static_cast<int>(n % kChildren);
    const int first_i = (tile & 3) * MICA_TILE + (child & 3) * MICA_LEAF,
              first_j = (tile >> 2) * MICA_TILE + (child >> 2) * MICA_LEAF;
    Leaf leaf;
    unsigned present = 0;
    for (int k = 0; k < kChildren; ++k) {
      const int i = first_i + (k & 3), j = first_j + (k >> 2);
      if (block_x * MICA_BLOCK + i >= grid.width || block_y * MICA_BLOCK + j >= grid.height) continue;
      leaf[k] = to_lobe(moments[j * MICA_BLOCK + i]);
      present |= 1u << k;
    }
    store_leaf(leaf, present, block + n * MICA_LOBE_LEAF);
  }
}

/// A leaf's lobes as they are stored.
std::vector<ElementMoments> leaf_lobes(const std::int16_t* leaf, int room_i, int room_j) {
  std::vector<ElementMoments> lobes;
  for (int k = 0; k < kChildren; ++k)
    if ((k & 3) < room_i && (k >> 2) < room_j) lobes.push_back(slope_moments_of(load_lobe(leaf, k)));
  return lobes;
}

void store_nodes(const std::int16_t* block, int room_i, int room_j, const BoundUnits& units,
                 std::int16_t* block_node, std::int16_t* tile_nodes) {
  for (int tile = 0; tile < kChildren; ++tile) {
    std::vector<ElementMoments> tile_lobes;
    for (int leaf = 0; leaf < kChildren; ++leaf) {
      const std::vector<ElementMoments> lobes =
          leaf_lobes(block + (tile * kChildren + leaf) * MICA_LOBE_LEAF,
                     room_i - (tile & 3) * MICA_TILE - (leaf & 3) * MICA_LEAF,
                     room_j - (tile >> 2) * MICA_TILE - (leaf >> 2) * MICA_LEAF);
      store_bound(lobes, units, leaf, tile_nodes + tile * MICA_MIXTURE_NODE_STRIDE);
      tile_lobes.insert(tile_lobes.end(), lobes.begin(), lobes.end());
    }
    store_bound(tile_lobes, units, tile, block_node);
  }
}

}  // namespace

std::size_t LobeStructure::bytes() const {
  return (lobes.size() + block_nodes.size() + tile_nodes.size()) * sizeof(std::int16_t);
}

Lobe LobeStructure::lobe(int i, int j) const {
  const std::size_t block = static_cast<std::size_t>(j / MICA_BLOCK) * grid.blocks_x + i / MICA_BLOCK;
  i %= MICA_BLOCK, j %= MICA_BLOCK;
  const int tile = j / MICA_TILE * 4 + i / MICA_TILE;
  i %= MICA_TILE, j %= MICA_TILE;
  const int leaf = j / MICA_LEAF * 4 + i / MICA_LEAF;
  return load_lobe(lobes.data() + ((block * kChildren + tile) * kChildren + leaf) * MICA_LOBE_LEAF,
                   j % MICA_LEAF * MICA_LEAF + i % MICA_LEAF);
}

std::size_t lobe_structure_bytes(int width, int height, int elements) {
  const std::size_t count = static_cast<std::size_t>(blocks(width * elements)) * blocks(height * elements);
  return count * (kLeavesABlock * MICA_LOBE_LEAF + (1 + kChildren) * MICA_MIXTURE_NODE_STRIDE) *
         sizeof(std::int16_t);
}

LobeStructure build_lobes(const Surface& surface, int elements) {
  if (elements < 1 || elements > kMaxElements)
    throw UsageError(
        fmt::format("{} elements a texel and axis; mixtures take 1 to {}", elements, kMaxElements));
  if (surface.interpolation() == Interpolation::bicubic)
    throw UsageError("beckmanns takes nearest and bilinear maps; this one is bicubic");
  LobeStructure map;
  const int width = surface.width() * elements, height = surface.height() * elements;
  map.grid = {width, height, blocks(width), blocks(height)};
  const std::size_t count = static_cast<std::size_t>(map.grid.blocks_x) * map.grid.blocks_y;
  map.lobes.assign(count * kLeavesABlock * MICA_LOBE_LEAF, 0);
  map.block_nodes.assign(count * MICA_MIXTURE_NODE_STRIDE, 0);
  map.tile_nodes.assign(count * kChildren * MICA_MIXTURE_NODE_STRIDE, 0);
  const auto room = [&](std::size_t block) {
    return std::pair(map.grid.width - static_cast<int>(block % map.grid.blocks_x) * MICA_BLOCK,
                     map.grid.height - static_cast<int>(block / map.grid.blocks_x) * MICA_BLOCK);
  };

  std::vector<LobeRange> ranges(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t block) {
    std::int16_t* lobes = map.lobes.data() + block * kLeavesABlock * MICA_LOBE_LEAF;
    store_block(surface, elements, static_cast<int>(block % map.grid.blocks_x),
                static_cast<int>(block / map.grid.blocks_x), map.grid, lobes);
    const auto [room_i, room_j] = room(block);
    for (std::size_t n = 0; n < kLeavesABlock; ++n) {
      const int i = static_cast<int>(n / kChildren % 4 * MICA_TILE + n % 4 * MICA_LEAF),
                j = static_cast<int>(n / kChildren / 4 * MICA_TILE + n % kChildren / 4 * MICA_LEAF);
      for (const ElementMoments& lobe : leaf_lobes(lobes + n * MICA_LOBE_LEAF, room_i - i, room_j - j))
        ranges[block].add(lobe);
    }
  });
  LobeRange all;
  for (const LobeRange& range : ranges) all.add(range);
  // Of floats that are a little too large nothing is clamped; a bound's spreads are at most sqrt(2) of an
  // element's.
  constexpr double margin = 1 + 1e-4, least = 1e-12;
  map.slope_unit = static_cast<float>(std::max(all.slope, least) * margin / kLargest16);
  map.spread_unit = static_cast<float>(std::max(std::sqrt(2.0) * all.spread, least) * margin / kLargest16);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t block) {
    const auto [room_i, room_j] = room(block);
    store_nodes(map.lobes.data() + block * kLeavesABlock * MICA_LOBE_LEAF, room_i, room_j,
                {map.slope_unit, map.spread_unit}, map.block_nodes.data() + block * MICA_MIXTURE_NODE_STRIDE,
                map.tile_nodes.data() + block * kChildren * MICA_MIXTURE_NODE_STRIDE);
  });
  return map;
}

}  // namespace mica::host
