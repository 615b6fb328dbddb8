#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mica::host::synthesis {

/// Points on a square torus, no two closer than a minimum distance, thrown until hardly any more fit.
class PoissonDisk {
 public:
  /// @param period side of the torus; @param minimum_distance above 0, at most period / 4.
  PoissonDisk(double period, double minimum_distance, std::uint64_t seed);

  /// The points, in [0, period)^2; never empty.
  const std::vector<Eigen::Vector2d>& points() const { return points_; }

  /// Index of the point nearest to `position` in [0, period)^2, around the torus.
  std::uint32_t nearest(const Eigen::Vector2d& position) const;

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffffu;

  std::size_t cell_index(long x, long y) const;
  bool has_room(const Eigen::Vector2d& position, long x, long y) const;
  double squared_distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;

  double period_, minimum_distance_;
  long cells_ =
      0;  ///< a side; a cell's diagonal is at most the minimum distance, so it holds one point at most
  std::vector<std::uint32_t> point_of_cell_;
  std::vector<Eigen::Vector2d> points_;
};

}  // namespace mica::host::synthesis
