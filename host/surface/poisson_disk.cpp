#include "host/surface/poisson_disk.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <utility>

#include "host/base/random.h"

namespace mica::host::synthesis {
namespace {

enum DartStream : std::uint64_t { dart_order_stream, dart_stream };  // dart_stream + 2 * round: x, + 1: y

/// 0 .. count-1 in random order (Fisher-Yates).
std::vector<std::uint32_t> shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t left = count; left > 1; --left) {
    std::swap(order[left - 1], order[random_bits(seed, dart_order_stream, left) % left]);
  }
  return order;
}

}  // namespace

PoissonDisk::PoissonDisk(double period, double minimum_distance, std::uint64_t seed)
    : period_(period), minimum_distance_(minimum_distance) {
  cells_ = static_cast<long>(std::ceil(period / minimum_distance * std::sqrt(2.0)));
  point_of_cell_.assign(static_cast<std::size_t>(cells_ * cells_), kEmpty);
  // Dart throwing, one dart a free cell and round. The first round, which three quarters of the points come
  // from, takes the cells in random order, so that no direction or position is preferred; the others in the
  // order of memory.
  const int rounds = 32;
  std::vector<std::uint32_t> free_cells = shuffled(point_of_cell_.size(), seed);
  for (std::uint64_t round = 0; round < rounds; ++round) {
    const auto is_hit = [&](std::uint32_t cell) {
      const long x = cell % cells_, y = cell / cells_;
      const double dart_x = random_unit(seed, dart_stream + 2 * round, cell);
      const double dart_y = random_unit(seed, dart_stream + 2 * round + 1, cell);
      const Eigen::Vector2d position =
          period_ / static_cast<double>(cells_) *
          Eigen::Vector2d(static_cast<double>(x) + dart_x, static_cast<double>(y) + dart_y);
      if (!has_room(position, x, y)) return false;
      point_of_cell_[cell] = static_cast<std::uint32_t>(points_.size());
      points_.push_back(position);
      return true;
    };
    std::vector<std::uint32_t> still_free;
    for (const std::uint32_t cell : free_cells) {
      if (!is_hit(cell)) still_free.push_back(cell);
    }
    free_cells = std::move(still_free);
    if (round == 0) std::sort(free_cells.begin(), free_cells.end());
  }
}

std::size_t PoissonDisk::cell_index(long x, long y) const {
  const auto wrap = [this](long c) {  // cells lie at most a few periods away: no division
    while (c < 0) c += cells_;
    while (c >= cells_) c -= cells_;
    return c;
  };
  return static_cast<std::size_t>(wrap(y) * cells_ + wrap(x));
}

double PoissonDisk::squared_distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
  const Eigen::Array2d d = (a - b).array().abs();
  return d.min(period_ - d).square().sum();
}

bool PoissonDisk::has_room(const Eigen::Vector2d& position, long x, long y) const {
  const long reach = 2;  // cells; sqrt(2) of them span the minimum distance
  for (long dy = -reach; dy <= reach; ++dy) {
    for (long dx = -reach; dx <= reach; ++dx) {
      const std::uint32_t other = point_of_cell_[cell_index(x + dx, y + dy)];
      if (other == kEmpty) continue;
      if (squared_distance(position, points_[other]) < minimum_distance_ * minimum_distance_) return false;
    }
  }
  return true;
}

std::uint32_t PoissonDisk::nearest(const Eigen::Vector2d& position) const {
  const double side = period_ / static_cast<double>(cells_);
  const long x = static_cast<long>(position.x() / side), y = static_cast<long>(position.y() / side);
  std::uint32_t best = kEmpty;
  double best_distance = std::numeric_limits<double>::infinity();  // squared
  // Square rings of cells around the position; what lies outside ring m is farther than m cells.
  for (long ring = 0; ring == 0 || best_distance > std::pow(static_cast<double>(ring - 1) * side, 2);
       ++ring) {
    for (long dy = -ring; dy <= ring; ++dy) {
      const long step = std::abs(dy) == ring ? 1 : 2 * ring;
      for (long dx = -ring; dx <= ring; dx += step) {
        const std::uint32_t point = point_of_cell_[cell_index(x + dx, y + dy)];
        if (point == kEmpty) continue;
        const double distance = squared_distance(position, points_[point]);
        if (distance < best_distance || (distance == best_distance && point < best)) {
          best_distance = distance;
          best = point;
        }
      }
    }
  }
  return best;
}

}  // namespace mica::host::synthesis
