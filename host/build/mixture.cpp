#include "host/build/mixture.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "host/base/error.h"
#include "host/build/normal_box.h"

namespace mica {
namespace {

using namespace device_types;

constexpr int kChildren = 16;

/// What a node says of the elements under it, in fixed point.
struct ElementBound {
  NormalBox means;
  double spread = 0;  ///< largest standard deviation of an element's normals

  void add(const ElementBound& other) {
    means.add(other.means);
    spread = std::max(spread, other.spread);
  }
};

void store(const ElementBound& bound, int child, std::int16_t* node) {
  store(bound.means, child, node);
  const double spread = std::ceil(bound.spread * MICA_BOUND_ONE / MICA_NORMAL_ONE);
  node[child + 64] = static_cast<std::int16_t>(std::min<double>(spread, INT16_MAX));
}

/// Larger singular value of the matrix with columns a and b.
double spectral_norm(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double half_difference = 0.5 * (a.squaredNorm() - b.squaredNorm());
  return std::sqrt(0.5 * (a.squaredNorm() + b.squaredNorm()) + std::hypot(half_difference, a.dot(b)));
}

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
      ElementBound tile_bound;
      for (int leaf = 0; leaf < kChildren; ++leaf) {
        const ElementBound leaf_bound = bound_leaf((tile & 3) * MICA_TILE + (leaf & 3) * MICA_LEAF,
                                                   (tile >> 2) * MICA_TILE + (leaf >> 2) * MICA_LEAF);
        store(leaf_bound, leaf, tile_nodes + tile * MICA_MIXTURE_NODE_STRIDE);
        tile_bound.add(leaf_bound);
      }
      store(tile_bound, tile, block_node);
    }
  }

 private:
  ElementBound bound_leaf(int first_i, int first_j) const {
    ElementBound bound;
    for (int j = first_j; j < std::min(first_j + MICA_LEAF, room_j_); ++j)
      for (int i = first_i; i < std::min(first_i + MICA_LEAF, room_i_); ++i) bound.add(bound_quad(i, j));
    return bound;
  }

  ElementBound bound_quad(int i, int j) const {
    ElementBound bound;
    const Eigen::Vector2d s00 = normal(i, j);
    if (constant_texels_) {
      bound.means.add(std::llround(s00.x()), std::llround(s00.y()));
      return bound;
    }
    const Eigen::Vector2d x = normal(i + 1, j) - s00, y = normal(i, j + 1) - s00;
    const Eigen::Vector2d xy = normal(i + 1, j + 1) - s00 - x - y;
    const double kernel_sigma = std::sqrt(kPositionKernelVariance) / elements_;
    for (int b = 0; b < elements_; ++b) {
      for (int a = 0; a < elements_; ++a) {
        const double f = (a + 0.5) / elements_, g = (b + 0.5) / elements_;
        const Eigen::Vector2d mean = s00 + f * x + g * y + f * g * xy;
        bound.means.add(std::llround(mean.x()), std::llround(mean.y()));
        bound.spread = std::max(bound.spread, kernel_sigma * spectral_norm(x + g * xy, y + f * xy));
      }
    }
    return bound;
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

}  // namespace mica
