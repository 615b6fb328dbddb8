#pragma once

#include <memory>
#include <vector>

#include "host/scene/description.h"
#include "host/scene/piecewise_constant.h"

namespace mica::host {

/// Light from all around and from far away, and directions drawn by how bright they are: the sum of a scene's
/// environment lights. Immutable after construction; used from any number of threads.
///
/// Directions are drawn from a density that is constant on each pixel of an image, in proportion to the mean
/// of its bilinear radiance there (Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., sec.
/// 12.5): wherever radiance is not zero, neither is the density.
class Environment {
 public:
  /// Throws FileError for an image that cannot be used: unreadable, or with pixels that are no radiance and
  /// not to be repaired.
  /// @param findings what was repaired in images.
  explicit Environment(const std::vector<EnvironmentLight>& lights, Findings* findings = nullptr);
  ~Environment();
  Environment(Environment&&) noexcept;

  bool is_black() const { return lights_.empty(); }

  /// @param direction of any length but 0.
  Color radiance(const Eigen::Vector3d& direction) const;

  /// A unit direction for two uniform numbers in [0, 1); not for a black environment.
  Eigen::Vector3d sample(const Eigen::Vector2d& uniform) const;

  /// With which `sample` draws a direction, per steradian; 0 everywhere when the environment is black.
  double pdf(const Eigen::Vector3d& direction) const;

 private:
  class Light;
  std::vector<std::unique_ptr<Light>> lights_;  // those that shine
  PiecewiseConstant choice_;                    // among them, by power
};

}  // namespace mica::host
