#include "host/scene/curve.h"

#include <algorithm>
#include <utility>

namespace mica::host {

Curve::Curve(std::vector<Point> points) : points_(std::move(points)) {}

double Curve::slope(std::size_t point) const {
  const Point& before = points_[point > 0 ? point - 1 : point];
  const Point& after = points_[std::min(point + 1, points_.size() - 1)];
  return (after.y - before.y) / (after.x - before.x);
}

double Curve::at(double x) const {
  if (x <= points_.front().x) return points_.front().y;
  if (x >= points_.back().x) return points_.back().y;
  const auto above =
      std::upper_bound(points_.begin(), points_.end(), x, [](double a, const Point& p) { return a < p.x; });
  const auto end = static_cast<std::size_t>(above - points_.begin());
  const Point &a = points_[end - 1], &b = points_[end];
  const double length = b.x - a.x, t = (x - a.x) / length, t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * a.y + (3 * t2 - 2 * t3) * b.y +
         length * ((t3 - 2 * t2 + t) * slope(end - 1) + (t3 - t2) * slope(end));
}

}  // namespace mica::host
