#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace mica::host {

/// A square image over the disk of half vectors: pixels row by row from the top left, s to the right, t up.
struct ImageWindow {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius = 1;  ///< half its side
  int pixels = 512;   ///< a side

  std::size_t count() const { return static_cast<std::size_t>(pixels) * pixels; }
  double step() const { return 2 * radius / pixels; }

  /// At the centre of a pixel.
  Eigen::Vector2d half_vector(std::size_t pixel) const {
    const auto side = static_cast<std::size_t>(pixels);
    const auto at = [&](std::size_t index) { return (2 * static_cast<double>(index) + 1) / pixels - 1; };
    return center + radius * Eigen::Vector2d(at(pixel % side), -at(pixel / side));
  }

  std::vector<std::size_t> pixels_on_disk() const {
    std::vector<std::size_t> inside;
    for (std::size_t pixel = 0; pixel < count(); ++pixel)
      if (half_vector(pixel).squaredNorm() < 1) inside.push_back(pixel);
    return inside;
  }
};

}  // namespace mica::host
