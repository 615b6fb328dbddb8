#include "host/methods/gaussians/mixture.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "host/methods/gaussians/mixture_bound.h"
#include "mica/error.h"

namespace mica::host {
namespace {

using namespace device_types;

constexpr int kChildren = 16;

constexpr double kUnit = static_cast<double>(MICA_NORMAL_ONE) / MICA_BOUND_ONE;
constexpr BoundUnits kUnits{kUnit, MICA_SPREAD_UNIT* kUnit};

/// Bounds of one block's elements, from its stored normals.
class BlockBounds {
 public:
  BlockBounds(const std::int32_t* normals, bool constant_texels, int elements, int room_i, int room_j)
      : normals_(normals),
        constant_texels_(constant_texels),
        elements_(elements),
        room_i_(room_i),
        room_j_(room_j) {}

  void write(std::int16_t* block_node, std::int16_t* tile_nodes) const {
    for (int tile = 0; tile < kChildren; ++tile) {
      std::vector<ElementMoments> tile_elements;
      for (int leaf = 0; leaf < kChildren; ++leaf) {
        const std::vector<ElementMoments> elements =
            leaf_elements((tile & 3) * MICA_TILE + (leaf & 3) * MICA_LEAF,
                          (tile >> 2) * MICA_TILE + (leaf >> 2) * MICA_LEAF);
        store_bound(elements, kUnits, leaf, tile_nodes + tile * MICA_MIXTURE_NODE_STRIDE);
        tile_elements.insert(tile_elements.end(), elements.begin(), elements.end());
      }
      store_bound(tile_elements, kUnits, tile, block_node);
    }
  }

 private:
  std::vector<ElementMoments> leaf_elements(int first_i, int first_j) const {
    std::vector<ElementMoments> elements;
    for (int j = first_j; j < std::min(first_j + MICA_LEAF, room_j_); ++j)
      for (int i = first_i; i < std::min(first_i + MICA_LEAF, room_i_); ++i) add_quad(i, j, &elements);
    return elements;
  }

  void add_quad(int i, int j, std::vector<ElementMoments>* elements) const {
    const Eigen::Vector2d s00 = normal(i, j);
    if (constant_texels_) {
      elements->push_back({s00, 0, 0, 0});
      return;
    }
    const Eigen::Vector2d x = normal(i + 1, j) - s00, y = normal(i, j + 1) - s00;
    const Eigen::Vector2d xy = normal(i + 1, j + 1) - s00 - x - y;
    const double variance = kPositionKernelVariance / (elements_ * elements_);
    for (int b = 0; b < elements_; ++b) {
      for (int a = 0; a < elements_; ++a) {
        const double f = (a + 0.5) / elements_, g = (b + 0.5) / elements_;
        const Eigen::Vector2d by_x = x + g * xy, by_y = y + f * xy;  // columns of the Jacobian
        elements->push_back({s00 + f * x + g * y + f * g * xy,
                             variance * (by_x.x() * by_x.x() + by_y.x() * by_y.x()),
                             variance * (by_x.x() * by_x.y() + by_y.x() * by_y.y()),
                             variance * (by_x.y() * by_x.y() + by_y.y() * by_y.y())});
      }
    }
  }

  Eigen::Vector2d normal(int i, int j) const {
    const int at = (j + 1) * MICA_BLOCK_ROW + i + 1;
    return {static_cast<double>(normals_[at]), static_cast<double>(normals_[at + MICA_BLOCK_PLANE])};
  }

  const std::int32_t* normals_;
  bool constant_texels_;
  int elements_, room_i_, room_j_;
};

}  // namespace

MapStructure build_gaussian_mixture(const Surface& surface, int elements) {
  if (elements < 1 || elements > kMaxElements)
    throw UsageError(
        fmt::format("{} elements a texel and axis; mixtures take 1 to {}", elements, kMaxElements));
  if (surface.interpolation() == Interpolation::bicubic)
    throw UsageError("gaussians takes nearest and bilinear maps; this one is bicubic");
  MapStructure map = build_map_structure(surface);
  const std::size_t count = map.block_nodes.size() / MICA_NODE_STRIDE;
  map.block_nodes.assign(count * MICA_MIXTURE_NODE_STRIDE, 0);
  map.tile_nodes.assign(count * kChildren * MICA_MIXTURE_NODE_STRIDE, 0);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t block) {
    const int block_x = static_cast<int>(block % map.grid.blocks_x),
              block_y = static_cast<int>(block / map.grid.blocks_x);
    BlockBounds(map.normals.data() + block * MICA_BLOCK_STRIDE,
                surface.interpolation() == Interpolation::nearest, elements,
                map.grid.width - block_x * MICA_BLOCK, map.grid.height - block_y * MICA_BLOCK)
        .write(map.block_nodes.data() + block * MICA_MIXTURE_NODE_STRIDE,
               map.tile_nodes.data() + block * kChildren * MICA_MIXTURE_NODE_STRIDE);
  });
  return map;
}

std::size_t gaussian_mixture_bytes(int width, int height) {
  const std::size_t nodes = static_cast<std::size_t>((width + MICA_BLOCK - 1) / MICA_BLOCK) *
                            ((height + MICA_BLOCK - 1) / MICA_BLOCK) * (1 + kChildren);
  return map_structure_bytes(width, height) +
         nodes * (MICA_MIXTURE_NODE_STRIDE - MICA_NODE_STRIDE) * sizeof(std::int16_t);
}

}  // namespace mica::host
