#pragma once

#include <vector>

namespace mica::host {

/// A smooth curve y(x) through given points: cubic Hermite pieces whose slopes are those of the chords beside
/// a point. Constant beyond both ends.
class Curve {
 public:
  struct Point {
    double x, y;
  };
  /// @param points at least two, x increasing.
  explicit Curve(std::vector<Point> points);

  double at(double x) const;

 private:
  double slope(std::size_t point) const;

  std::vector<Point> points_;
};

}  // namespace mica::host
