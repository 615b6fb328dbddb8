#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/scene/description.h"
#include "host/scene/hit.h"

namespace mica::host {

/// A ray that leaves a hit along `direction`, on the side of the surface to which that points.
Ray ray_from(const Hit& hit, const Eigen::Vector3d& direction);

/// All shapes of a scene, ready to be hit. Immutable after construction; used from any number of threads.
/// Shapes whose descriptions differ in nothing but their placement and materials are built once.
class Geometry {
 public:
  /// Throws FileError for a mesh that cannot be used, UsageError for a shape without extent.
  explicit Geometry(const std::vector<ShapeDescription>& shapes);
  ~Geometry();
  Geometry(Geometry&&) noexcept;

  /// Names of the parts of shape `shape`; none when it is all one.
  const std::vector<std::string>& parts(std::size_t shape) const;

  /// The first hit at t > 0.
  std::optional<Hit> intersect(const Ray& ray) const;

  /// Whether anything lies within `distance` of a hit along the unit `direction`, on the side of the surface
  /// to which that direction points.
  bool occluded(const Hit& hit, const Eigen::Vector3d& direction, double distance) const;

  /// How many of some rays are not.
  std::size_t count_open(const Hit& hit, const std::vector<ShadowRay>& rays) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace mica::host
