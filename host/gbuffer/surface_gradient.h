#pragma once

#include <Eigen/Core>
#include <array>

#include "host/gbuffer/gbuffer.h"
#include "host/scene/hit.h"

namespace mica::host {

/// What a pixel's neighbours on the same surface tell of it, or where some are missing its derivatives.
struct SurfaceGradient {
  /// Along both axes of the image there is a neighbour, or there are derivatives, so that what follows is
  /// known.
  bool is_known = false;
  std::array<bool, 9>
      is_near{};  ///< by place of FitStencil::centers(): the same surface, without a seam between
  Eigen::Vector3d x{1, 0, 0}, y{0, 1, 0};             ///< orthonormal axes of the surface's plane
  Eigen::Matrix2d duv = Eigen::Matrix2d::Identity();  ///< change of uv per unit of length along them

  bool has_all() const;
  /// Place of a neighbour on those axes.
  Eigen::Vector2d on_plane(const Eigen::Vector3d& step) const { return {step.dot(x), step.dot(y)}; }
};

/// The uv of one pixel beside those of another: uv repeat, so that a step of whole periods is none.
Eigen::Vector2d uv_step(const BufferPixel& from, const BufferPixel& to);

/// A least-squares gradient: of steps of a pair of numbers over steps on a plane.
class PlaneGradient {
 public:
  /// @param squared_pixels distance in the image.
  void add(const Eigen::Vector2d& place, const Eigen::Vector2d& step, double squared_pixels);
  bool is_known() const;  ///< places lie along more than one line
  /// Of places along one line the change along it; zero without any.
  Eigen::Matrix2d value() const;

 private:
  Eigen::Matrix2d moments_ = Eigen::Matrix2d::Zero(), products_ = Eigen::Matrix2d::Zero();
};

/// Of the pixel at a place that has a material. Pixels around it have to be there.
SurfaceGradient surface_gradient(const Rectangle<BufferPixel>& pixels, int row, int column);

/// Where the eye meets a pixel's surface, but for its distance, shape and part. Of a gradient that is not
/// known uv do not change.
Hit hit_of(const BufferPixel& pixel, const SurfaceGradient& gradient);

}  // namespace mica::host
