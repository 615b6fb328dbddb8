#pragma once

#include <Eigen/Core>

#include "host/scene/camera.h"
#include "host/scene/hit.h"

namespace mica::host {

/// Change of the position per pixel to the right (first column) and down (second column), on the tangent
/// plane of the hit: ray differentials [Igehy99], Homan Igehy, "Tracing Ray Differentials", SIGGRAPH 1999,
/// sec. 3.1.
Eigen::Matrix<double, 3, 2> position_differentials(const CameraRay& ray, const Hit& hit);

/// Change of the shape's uv per pixel to the right (first column) and down (second column).
Eigen::Matrix2d uv_differentials(const CameraRay& ray, const Hit& hit);

/// Covariance in uv^2 of a Gaussian pixel filter with standard deviation `sigma_pixels` pushed through `duv`.
///
/// Bounded so that it can be inverted in single precision: axes below 1e-7 of a map period are lengthened to
/// that; an axis longer than 100 times the other, as at the silhouettes of shapes, is shortened to that
/// (lengthening the other one instead would blur, and cost more).
Eigen::Matrix2d footprint_covariance(const Eigen::Matrix2d& duv, double sigma_pixels);

/// The half vector's change per unit of uv, where it changes by `dh` (a column a pixel to the right and down)
/// and uv by `duv`; zero where uv hardly change along one direction, or the half vector by too much over
/// `sigma_pixels`.
Eigen::Matrix2d turn_over(const Eigen::Matrix2d& duv, const Eigen::Matrix2d& dh, double sigma_pixels);

}  // namespace mica::host
