#pragma once

#include <Eigen/Core>

namespace mica::host {

/// Of a linear colour with the primaries of Rec. 709.
inline double luminance(const Eigen::Vector3d& color) {
  return color.dot(Eigen::Vector3d(0.2126, 0.7152, 0.0722));
}

}  // namespace mica::host
