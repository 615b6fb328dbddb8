#include "host/reference/best_first_search.h"

#include <algorithm>
#include <cmath>

#include "host/reference/gaussian_triangle.h"

namespace mica::host::reference {

BestFirstSearch::BestFirstSearch(const CellMap& map, const NormalPyramid& pyramid, const TriangleRules& rules,
                                 const QueryFrame& frame, RunningIntegral* integral)
    : map_(map),
      pyramid_(pyramid),
      frame_(frame),
      integral_(*integral),
      block_integrator_(map, rules, frame, integral) {}

void BestFirstSearch::run() {
  push_periods();
  while (!queue_.empty() && queue_.front().urgency < integral_.cut()) {
    const Node node = pop();
    if (node.level > 0) {
      open(node);
    } else {
      block_integrator_.integrate(node.i, node.j, node.period_x, node.period_y);
    }
  }
  for (const Node& node : queue_) integral_.skip(node.area_texels, node.nearest_squared);
}

/// The top node, once for every period of the plane that the footprint may reach, row by row of periods.
void BestFirstSearch::push_periods() {
  const int top = pyramid_.top_level();
  if (frame_.covers_evenly()) return push(top, 0, 0, 0, 0);
  const Eigen::Matrix2d& cov = frame_.cov_texels();
  const Eigen::Vector2d period = map_.corner_texels(map_.columns(), map_.rows()) - map_.corner_texels(0, 0);
  const Eigen::Vector2d mean = frame_.mean_texels() - map_.corner_texels(0, 0);
  const double radius = std::sqrt(RunningIntegral::largest_q);
  const double reach_y = radius * std::sqrt(cov(1, 1));
  const double lean = cov(0, 1) / cov(1, 1);
  const double reach_x = radius * std::sqrt(std::max(0.0, cov(0, 0) - lean * cov(0, 1)));

  const long last_row = std::lround(std::floor((mean.y() + reach_y) / period.y()));
  for (long row = std::lround(std::floor((mean.y() - reach_y) / period.y())); row <= last_row; ++row) {
    const double low_y = std::max(row * period.y() - mean.y(), -reach_y);
    const double high_y = std::min((row + 1) * period.y() - mean.y(), reach_y);
    const double low_x = mean.x() + std::min(lean * low_y, lean * high_y) - reach_x;
    const double high_x = mean.x() + std::max(lean * low_y, lean * high_y) + reach_x;
    const long last_column = std::lround(std::floor(high_x / period.x()));
    for (long column = std::lround(std::floor(low_x / period.x())); column <= last_column; ++column) {
      push(top, 0, 0, column, row);
    }
  }
}

void BestFirstSearch::push(int level, int i, int j, long period_x, long period_y) {
  const CellRange cells = cells_of(level, i, j, period_x, period_y);
  const double nearest_squared = lower_bound(pyramid_.bounds(level, i, j), cells);
  const double count = static_cast<double>((cells.end_i - cells.begin_i) * (cells.end_j - cells.begin_j));
  const double area = count * map_.cell_texels() * map_.cell_texels();
  const double urgency = nearest_squared - 2 * std::log(std::max(1.0, area / frame_.effective_area()));
  queue_.push_back({nearest_squared, area, urgency, level, i, j, period_x, period_y});
  std::push_heap(queue_.begin(), queue_.end(), is_later);
}

BestFirstSearch::Node BestFirstSearch::pop() {
  std::pop_heap(queue_.begin(), queue_.end(), is_later);
  const Node node = queue_.back();
  queue_.pop_back();
  return node;
}

void BestFirstSearch::open(const Node& node) {
  const int level = node.level - 1;
  for (int j = 2 * node.j; j < std::min(2 * node.j + 2, pyramid_.rows(level)); ++j) {
    for (int i = 2 * node.i; i < std::min(2 * node.i + 2, pyramid_.columns(level)); ++i) {
      push(level, i, j, node.period_x, node.period_y);
    }
  }
}

BestFirstSearch::CellRange BestFirstSearch::cells_of(int level, int i, int j, long period_x,
                                                     long period_y) const {
  const long cells = static_cast<long>(CellMap::block_cells) << level;
  const long first_i = period_x * map_.columns(), first_j = period_y * map_.rows();
  return {first_i + i * cells, first_j + j * cells, first_i + std::min<long>((i + 1) * cells, map_.columns()),
          first_j + std::min<long>((j + 1) * cells, map_.rows())};
}

double BestFirstSearch::lower_bound(const NormalBox& box, const CellRange& cells) const {
  const auto corner = [&](long i, long j) { return frame_.whiten_position(map_.corner_texels(i, j)); };
  const Eigen::Vector2d corners[4] = {corner(cells.begin_i, cells.begin_j),
                                      corner(cells.end_i, cells.begin_j), corner(cells.end_i, cells.end_j),
                                      corner(cells.begin_i, cells.end_j)};
  return frame_.lobe_distance_squared(box, corners, 4) + nearest_squared(corners, 4);
}

}  // namespace mica::host::reference
