#include "host/scene/polygon.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace mica::host {
namespace {

using Vector2 = Eigen::Vector2d;

/// Twice the area to the left of a, b, c.
double area(const Vector2& a, const Vector2& b, const Vector2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Cuts ears off a polygon, seen along its normal (Meisters, "Polygons Have Ears", 1975).
class EarCutter {
 public:
  EarCutter(const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector3d& normal)
      : left_(corners.size()) {
    const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.cross(x);
    for (const Eigen::Vector3d& corner : corners) {
      const Eigen::Vector3d from_first = corner - corners[0];
      points_.emplace_back(from_first.dot(x), from_first.dot(y));
    }
    std::iota(left_.begin(), left_.end(), std::size_t{0});
  }

  std::vector<std::array<std::size_t, 3>> cut() {
    std::vector<std::array<std::size_t, 3>> triangles;
    std::size_t at = 1;
    while (left_.size() > 2) {
      at = next_ear(at % left_.size());
      const auto [a, b, c] = around(at);
      const double twice = area(points_[a], points_[b], points_[c]);
      covered_ += std::abs(twice);
      if (twice != 0) triangles.push_back({a, b, c});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
      if (at == left_.size()) at = 0;
      if (left_.size() > 1 && left_[at] == 0) ++at;  // a fan around the first corner, while there is a choice
    }
    return triangles;
  }

  /// Twice the area of all triangles, those that turn the other way included.
  double covered() const { return covered_; }

  bool is_convex() const {
    for (std::size_t n = 0; n < left_.size(); ++n)
      if (turn(n) < 0) return false;
    return true;
  }

 private:
  std::array<std::size_t, 3> around(std::size_t at) const {
    const std::size_t count = left_.size();
    return {left_[(at + count - 1) % count], left_[at], left_[(at + 1) % count]};
  }

  double turn(std::size_t at) const {
    const auto [a, b, c] = around(at);
    return area(points_[a], points_[b], points_[c]);
  }

  bool is_ear(std::size_t at) const {
    if (!(turn(at) > 0)) return false;
    const auto [ia, ib, ic] = around(at);
    const Vector2 &a = points_[ia], &b = points_[ib], &c = points_[ic];
    for (std::size_t n = 0; n < left_.size(); ++n) {
      const Vector2& p = points_[left_[n]];
      if (p == a || p == b || p == c || turn(n) > 0) continue;  // only where it turns right can it cut in
      if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) return false;
    }
    return true;
  }

  /// From `at` on; where rounding leaves none, the corner that matters least.
  std::size_t next_ear(std::size_t at) const {
    const std::size_t count = left_.size();
    std::size_t flattest = at;
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t candidate = (at + n) % count;
      if (is_ear(candidate)) return candidate;
      if (std::abs(turn(candidate)) < std::abs(turn(flattest))) flattest = candidate;
    }
    return flattest;
  }

  std::vector<Vector2> points_;
  std::vector<std::size_t> left_;  // corners that are not cut off yet
  double covered_ = 0;
};

}  // namespace

Eigen::Vector3d polygon_area(const std::vector<Eigen::Vector3d>& corners) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t n = 2; n < corners.size(); ++n)
    sum += (corners[n - 1] - corners[0]).cross(corners[n] - corners[0]);
  return sum;
}

std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Eigen::Vector3d>& corners) {
  constexpr std::size_t most_corners = 4096;  // an ear is searched among all corners
  const Eigen::Vector3d sum = polygon_area(corners);
  if (!(sum.norm() > 0)) return {};
  EarCutter cutter(corners, sum.normalized());
  if (corners.size() > most_corners && !cutter.is_convex()) return {};
  std::vector<std::array<std::size_t, 3>> triangles = cutter.cut();
  // Exporters round; what overlaps by more crosses itself.
  constexpr double tolerance = 1e-3;
  if (corners.size() > 4 && cutter.covered() > (1 + tolerance) * sum.norm()) return {};
  return triangles;
}

}  // namespace mica::host
