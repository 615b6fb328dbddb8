#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "host/surface/surface.h"

namespace mica::host {

/// The least rectangles of the disk that hold a map's normals, as they are interpolated, by place: of tiles,
/// and of tiles of twice the size on each level above. [Yan14] sec. 6
class NormalBounds {
 public:
  using Box = Eigen::AlignedBox2d;

  explicit NormalBounds(const Surface& surface);

  /// Holds all normals of a rectangle of the plane, in uv; the map repeats. Somewhat larger than need be.
  Box within(const Eigen::Vector2d& middle_uv, const Eigen::Vector2d& half_size_uv) const;

 private:
  struct Level {
    long side;           ///< texels of a tile
    long columns, rows;  ///< tiles a period; the last ones may be partly filled
    std::vector<Box> boxes;
  };

  long width_, height_;
  long apron_;    // texels beyond a quad's corners that its normals depend on
  double widen_;  // of their range, by which normals exceed them at most
  std::vector<Level> levels_;
};

}  // namespace mica::host
