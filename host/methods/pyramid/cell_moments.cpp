#include "host/methods/pyramid/cell_moments.h"

#include <algorithm>
#include <cmath>

#include "host/methods/pyramid/texel_pieces.h"

namespace mica::host {
namespace {

/// Of the block's mean, the weight that a light cell has at most: on noise a fifth of the cells, and 2% of
/// the weight.
constexpr double kLight = 0.2;

/// Of the cells around `part` that are not empty, the one with the nearest mean normal; null without any.
CellMoments* nearest_neighbour(const NormalCells& cells, const CellMoments& part,
                               std::vector<CellMoments>* parts) {
  CellMoments* nearest = nullptr;
  double least = 8 * cells.width() * cells.width();  // farther is the other end of a row of cells
  const Eigen::Vector2d normal = part.moments.mean().tail<2>();
  for (const int row : {-1, 0, 1}) {
    const int first = part.cell + row * cells.columns() - 1;
    auto found = std::lower_bound(parts->begin(), parts->end(), first,
                                  [](const CellMoments& a, int cell) { return a.cell < cell; });
    for (; found != parts->end() && found->cell <= first + 2; ++found) {
      if (&*found == &part || !(found->moments.weight > 0)) continue;
      const double distance = (found->moments.mean().tail<2>() - normal).squaredNorm();
      if (distance < least) nearest = &*found, least = distance;
    }
  }
  return nearest;
}

}  // namespace

NormalCells::NormalCells(const Surface& surface, double width) : width_(width) {
  Eigen::Vector2d low = surface.normals().front(), high = low;
  for (const Eigen::Vector2d& normal : surface.normals()) {
    low = low.cwiseMin(normal);
    high = high.cwiseMax(normal);
  }
  // Bicubic values overshoot: what lies outside falls into the outermost cells.
  low_s_ = low.x(), low_t_ = low.y();
  columns_ = static_cast<int>((high.x() - low.x()) / width) + 1;
  rows_ = static_cast<int>((high.y() - low.y()) / width) + 1;
}

int NormalCells::cell_of(double s, double t) const {
  const int column = std::clamp(static_cast<int>((s - low_s_) / width_), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>((t - low_t_) / width_), 0, rows_ - 1);
  return row * columns_ + column;
}

BlockMoments::BlockMoments(const Surface& surface, const NormalCells& cells)
    : surface_(surface), cells_(cells), place_of_cell_(cells.count(), -1) {}

std::vector<CellMoments> BlockMoments::block(int first_i, int first_j, int size) {
  if (first_i >= surface_.width() || first_j >= surface_.height()) return {};
  if (size < 2 * kBaseBlock) return base_block(first_i, first_j, size);
  const int half = size / 2;
  const std::vector<CellMoments> quarters[] = {
      block(first_i, first_j, half), block(first_i + half, first_j, half),
      block(first_i, first_j + half, half), block(first_i + half, first_j + half, half)};
  return merge({&quarters[0], &quarters[1], &quarters[2], &quarters[3]});
}

std::vector<CellMoments> BlockMoments::merge(const std::vector<const std::vector<CellMoments>*>& quarters) {
  for (const std::vector<CellMoments>* quarter : quarters)
    for (const CellMoments& part : *quarter) at(part.cell).add(part.moments);
  return take();
}

std::vector<CellMoments> BlockMoments::base_block(int first_i, int first_j, int size) {
  TexelPieces<BlockMoments> pieces(surface_, cells_.width(), this);
  for (int j = first_j; j < std::min(first_j + size, surface_.height()); ++j)
    for (int i = first_i; i < std::min(first_i + size, surface_.width()); ++i) pieces.cut(i, j);
  return take();
}

Moments& BlockMoments::at(int cell) {
  int& place = place_of_cell_[cell];
  if (place < 0) {
    place = static_cast<int>(sums_.size());
    sums_.push_back({cell, {}});
  }
  return sums_[place].moments;
}

std::vector<CellMoments> BlockMoments::take() {
  order_.clear();
  for (std::size_t n = 0; n < sums_.size(); ++n) order_.emplace_back(sums_[n].cell, static_cast<int>(n));
  std::sort(order_.begin(), order_.end());
  std::vector<CellMoments> taken;
  taken.reserve(order_.size());
  for (const auto& [cell, place] : order_) {
    taken.push_back(sums_[place]);
    place_of_cell_[cell] = -1;
  }
  sums_.clear();
  return taken;
}

CellCounter::CellCounter(const Surface& surface, const NormalCells& cells)
    : surface_(surface), cells_(cells), sums_(cells.count()) {}

CellCount CellCounter::count(int first_i, int first_j, int size) {
  TexelPieces<CellCounter> pieces(surface_, cells_.width(), this);
  for (int j = first_j; j < std::min(first_j + size, surface_.height()); ++j)
    for (int i = first_i; i < std::min(first_i + size, surface_.width()); ++i) pieces.cut(i, j);
  std::sort(touched_.begin(), touched_.end());
  // To tell light cells takes the weight and the mean normal of each.
  std::vector<CellMoments> parts(touched_.size());
  for (std::size_t n = 0; n < parts.size(); ++n) {
    Sum& sum = sums_[touched_[n]];
    parts[n].cell = touched_[n];
    parts[n].moments.weight = sum.weight;
    parts[n].moments.first.tail<2>() = sum.normal;
    sum = {};
  }
  touched_.clear();
  CellCount count;
  count.whole = static_cast<std::int64_t>(parts.size());
  count.compact = static_cast<std::int64_t>(without_light_cells(cells_, std::move(parts)).size());
  return count;
}

std::vector<CellMoments> without_light_cells(const NormalCells& cells, std::vector<CellMoments> parts) {
  double weight = 0;
  for (const CellMoments& part : parts) weight += part.moments.weight;
  const double light = kLight * weight / static_cast<double>(parts.size());
  for (CellMoments& part : parts) {
    if (part.moments.weight > light || !(part.moments.weight > 0)) continue;
    CellMoments* const neighbour = nearest_neighbour(cells, part, &parts);
    if (neighbour == nullptr) continue;
    neighbour->moments.add(part.moments);
    part.moments = {};
  }
  parts.erase(std::remove_if(parts.begin(), parts.end(),
                             [](const CellMoments& part) { return !(part.moments.weight > 0); }),
              parts.end());
  return parts;
}

}  // namespace mica::host
