#pragma once

#include <Eigen/Core>

#include "host/scene/description.h"

namespace mica::host {

/// origin + t * direction, and how the direction changes with the image position.
struct CameraRay {
  Eigen::Vector3d origin, direction;  ///< direction not normalised: one unit along the viewing axis
  Eigen::Vector3d ddx, ddy;           ///< change of the direction per pixel to the right and per pixel down
};

class PinholeCamera {
 public:
  /// Image size in pixels. Throws UsageError when the description spans no image plane.
  PinholeCamera(const CameraDescription& description, int width, int height);

  /// @param x, y pixels from the left and from the top edge; pixel centres lie at halves.
  CameraRay ray(double x, double y) const;

 private:
  Eigen::Vector3d position_, top_left_, ddx_, ddy_;
};

}  // namespace mica::host
