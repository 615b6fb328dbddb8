#include "host/methods/pyramid/moment_pyramid.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "host/methods/pyramid/cell_moments.h"
#include "host/methods/pyramid/element_tree.h"

namespace mica::host {
namespace {

using namespace device_types;

constexpr int kSampledTexels = 256;  // a side: of the sample that elements are counted in

/// Blocks of one size, row by row.
struct BlockGrid {
  int block = 0, columns = 0, rows = 0;
  std::vector<std::vector<CellMoments>> parts;

  BlockGrid(const Surface& surface, int block_texels)
      : block(block_texels),
        columns((surface.width() + block_texels - 1) / block_texels),
        rows((surface.height() + block_texels - 1) / block_texels),
        parts(static_cast<std::size_t>(columns) * rows) {}

  /// Null outside the map.
  std::vector<CellMoments>* at(int column, int row) {
    if (column >= columns || row >= rows) return nullptr;
    return &parts[static_cast<std::size_t>(row) * columns + column];
  }
};

using ThreadMoments = tbb::enumerable_thread_specific<BlockMoments>;

/// The next coarser grid; takes the finer one's parts.
BlockGrid merged(const Surface& surface, BlockGrid finer, ThreadMoments* moments) {
  BlockGrid grid(surface, 2 * finer.block);
  tbb::parallel_for(std::size_t{0}, grid.parts.size(), [&](std::size_t n) {
    const int column = static_cast<int>(n % grid.columns), row = static_cast<int>(n / grid.columns);
    std::vector<const std::vector<CellMoments>*> quarters;
    for (const int quarter : {0, 1, 2, 3}) {
      std::vector<CellMoments>* part = finer.at(2 * column + (quarter & 1), 2 * row + (quarter >> 1));
      if (part != nullptr) quarters.push_back(part);
    }
    grid.parts[n] = moments->local().merge(quarters);
    for (const int quarter : {0, 1, 2, 3}) {
      std::vector<CellMoments>* part = finer.at(2 * column + (quarter & 1), 2 * row + (quarter >> 1));
      if (part != nullptr) std::vector<CellMoments>().swap(*part);
    }
  });
  return grid;
}

/// Appends a group's nodes, whose children then follow those that are there.
void append_nodes(const std::vector<std::int16_t>& nodes, std::size_t children_before,
                  std::vector<std::int16_t>* all) {
  const std::size_t first = all->size();
  all->insert(all->end(), nodes.begin(), nodes.end());
  for (std::size_t at = first + 2 * MICA_PYRAMID_NODE_CHILD; at < all->size();
       at += MICA_PYRAMID_NODE_STRIDE) {
    std::int32_t child = 0;
    std::memcpy(&child, all->data() + at, sizeof child);
    child += static_cast<std::int32_t>(children_before);
    std::memcpy(all->data() + at, &child, sizeof child);
  }
}

PyramidLevel flatten(const Surface& surface, const NormalCells& cells, const PyramidLevels& levels,
                     BlockGrid* grid) {
  PyramidLevel level;
  level.shape.record_bits = levels.compact ? 8 : 16;
  const auto groups = [](int blocks) { return (blocks + MICA_GROUP_BLOCKS - 1) / MICA_GROUP_BLOCKS; };
  level.shape.grid = {surface.width(), surface.height(), groups(grid->columns), groups(grid->rows)};
  level.shape.group_size = grid->block * MICA_GROUP_BLOCKS;
  std::vector<ElementTree> trees(static_cast<std::size_t>(level.shape.grid.blocks_x) *
                                 level.shape.grid.blocks_y);
  tbb::parallel_for(std::size_t{0}, trees.size(), [&](std::size_t n) {
    const int column = static_cast<int>(n % level.shape.grid.blocks_x) * MICA_GROUP_BLOCKS;
    const int row = static_cast<int>(n / level.shape.grid.blocks_x) * MICA_GROUP_BLOCKS;
    std::vector<CellMoments> parts;
    for (int block = 0; block < MICA_GROUP_BLOCKS * MICA_GROUP_BLOCKS; ++block) {
      const std::vector<CellMoments>* part =
          grid->at(column + block % MICA_GROUP_BLOCKS, row + block / MICA_GROUP_BLOCKS);
      if (part == nullptr) continue;
      const std::vector<CellMoments>& kept = levels.compact ? without_light_cells(cells, *part) : *part;
      parts.insert(parts.end(), kept.begin(), kept.end());
    }
    GroupShape shape;
    shape.corner_texels = Eigen::Vector2d(column, row) * grid->block;
    shape.size_texels = level.shape.group_size;
    shape.block_texels = grid->block;
    shape.cell_width = levels.cell_width;
    shape.record_bits = level.shape.record_bits;
    trees[n] = build_element_tree(shape, parts);
  });
  double variance = 0;
  for (const ElementTree& tree : trees) {
    level.groups.push_back(static_cast<std::int32_t>(level.top_nodes.size() / MICA_PYRAMID_NODE_STRIDE));
    append_nodes(tree.top_nodes, level.nodes.size() / MICA_PYRAMID_NODE_STRIDE, &level.top_nodes);
    append_nodes(tree.nodes, level.records.size() / record_stride(level.shape.record_bits), &level.nodes);
    level.records.insert(level.records.end(), tree.records.begin(), tree.records.end());
    level.elements += tree.elements;
    variance = std::max(variance, tree.largest_variance);
  }
  level.groups.push_back(static_cast<std::int32_t>(level.top_nodes.size() / MICA_PYRAMID_NODE_STRIDE));
  level.shape.spread = std::sqrt(variance);
  return level;
}

}  // namespace

std::size_t PyramidLevel::bytes() const {
  return groups.size() * sizeof groups[0] +
         (top_nodes.size() + nodes.size() + records.size()) * sizeof records[0];
}

int whole_map_block(int map_width, int map_height, int finest_block) {
  int block = finest_block;
  while (block < std::max(map_width, map_height)) block *= 2;
  return block;
}

void build_moment_pyramid(const Surface& surface, const PyramidLevels& levels,
                          const std::function<void(int block, PyramidLevel level)>& take) {
  const NormalCells cells(surface, levels.cell_width);
  ThreadMoments moments([&] { return BlockMoments(surface, cells); });
  BlockGrid grid(surface, levels.finest_block);
  tbb::parallel_for(std::size_t{0}, grid.parts.size(), [&](std::size_t n) {
    const int column = static_cast<int>(n % grid.columns), row = static_cast<int>(n / grid.columns);
    grid.parts[n] = moments.local().block(column * grid.block, row * grid.block, grid.block);
  });
  const int coarsest = whole_map_block(surface.width(), surface.height(), levels.finest_block);
  for (;;) {
    take(grid.block, flatten(surface, cells, levels, &grid));
    if (grid.block >= coarsest) return;
    grid = merged(surface, std::move(grid), &moments);
  }
}

ElementCounts estimate_elements(const Surface& surface, double cell_width, int block, double most) {
  const int samples = std::clamp(kSampledTexels / block, 1, 8);  // a side: blocks spread over the map
  const NormalCells cells(surface, cell_width);
  const int columns = (surface.width() + block - 1) / block, rows = (surface.height() + block - 1) / block;
  const int sampled_columns = std::min(columns, samples), sampled_rows = std::min(rows, samples);
  const std::size_t samples_taken = static_cast<std::size_t>(sampled_columns) * sampled_rows;
  const double blocks_a_sample = static_cast<double>(columns) * rows / static_cast<double>(samples_taken);
  // Whole numbers, whose sums do not depend on their order.
  std::atomic<std::int64_t> whole = 0, compact = 0;
  const auto above_most = [&](const std::atomic<std::int64_t>& sum) {
    return blocks_a_sample * static_cast<double>(sum) > most;
  };
  tbb::enumerable_thread_specific<CellCounter> counters([&] { return CellCounter(surface, cells); });
  tbb::parallel_for(std::size_t{0}, samples_taken, [&](std::size_t n) {
    if (above_most(whole) && above_most(compact)) return;
    const int column = static_cast<int>(n % sampled_columns) * columns / sampled_columns;
    const int row = static_cast<int>(n / sampled_columns) * rows / sampled_rows;
    const CellCount count = counters.local().count(column * block, row * block, block);
    whole += count.whole, compact += count.compact;
  });
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (above_most(whole) && above_most(compact)) return {infinity, infinity};
  return {blocks_a_sample * static_cast<double>(whole), blocks_a_sample * static_cast<double>(compact)};
}

namespace {

/// What levels of one cell width take, each found when it is asked for.
class LevelEstimates {
 public:
  /// @param room bytes: what does not fit into it is infinite.
  LevelEstimates(const Surface& surface, double cell_width, double room)
      : surface_(surface),
        cell_width_(cell_width),
        room_(room),
        size_(std::max(surface.width(), surface.height())) {}

  /// Of a level and all coarser ones; infinite as soon as those are too much, without a look at finer ones.
  double bytes(int finest, bool compact) {
    int coarsest = finest;
    while (2 * coarsest <= kSampledTexels && coarsest < size_) coarsest *= 2;
    double sum = coarsest < size_ ? elements(coarsest, compact) / 3 : 0;  // a quarter each, or few
    for (int block = coarsest; block >= finest; block /= 2) {
      sum += elements(block, compact);
      if (sum * element_bytes(compact) > room_) return std::numeric_limits<double>::infinity();
    }
    return sum * element_bytes(compact);
  }
  /// Whether sixteen neighbouring elements of a group lie within eight cells or so of each other: 8 bits tell
  /// farther ones hardly apart, and a light one may be all there is.
  bool crowded(int block) {
    const double blocks = static_cast<double>(surface_.width()) * surface_.height() / (1.0 * block * block);
    return 64 * elements(block, true) / blocks >= NormalCells(surface_, cell_width_).count();
  }

 private:
  static double element_bytes(bool compact) {
    return (2.0 * record_stride(compact ? 8 : 16) + 2.0 * MICA_PYRAMID_NODE_STRIDE / 15) / 16;
  }
  double elements(int block, bool compact) {
    block = std::min(block, size_);  // wider ones are the whole map, too
    const auto [found, added] = elements_.try_emplace(block);
    if (added) found->second = estimate_elements(surface_, cell_width_, block, room_ / element_bytes(true));
    return compact ? found->second.compact : found->second.whole;
  }

  const Surface& surface_;
  double cell_width_, room_;
  int size_;
  std::map<int, ElementCounts> elements_;
};

}  // namespace

bool hardly_merges(const Surface& surface, double cell_width) {
  constexpr double hardly = 0.75;
  const NormalCells cells(surface, cell_width);
  std::vector<bool> is_met(static_cast<std::size_t>(cells.count()));
  std::size_t met = 0;
  for (const Eigen::Vector2d& normal : surface.normals()) {
    std::vector<bool>::reference cell = is_met[cells.cell_of(normal.x(), normal.y())];
    if (!cell) ++met;
    cell = true;
  }
  return static_cast<double>(met) >= hardly * static_cast<double>(surface.normals().size());
}

PyramidLevels levels_that_fit(const Surface& surface, double cell_width, std::size_t bytes) {
  const auto room = static_cast<double>(bytes);
  LevelEstimates estimates(surface, cell_width, room);
  for (int octave = kFinestBlock; octave < std::max(surface.width(), surface.height()); octave *= 2) {
    for (const int block : {octave, octave / 2 * 3}) {
      if (estimates.bytes(block, false) <= room) return {cell_width, block, false};
      if (estimates.bytes(block, true) <= room && estimates.crowded(block)) return {cell_width, block, true};
    }
  }
  return {cell_width, whole_map_block(surface.width(), surface.height(), kFinestBlock), false};
}

}  // namespace mica::host
