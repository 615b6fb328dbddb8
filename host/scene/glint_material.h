#pragma once

#include <optional>
#include <vector>

#include "host/base/glints.h"
#include "host/base/query.h"
#include "host/scene/camera.h"
#include "host/scene/description.h"
#include "host/scene/lobes.h"
#include "host/scene/shading.h"
#include "host/scene/smooth_material.h"
#include "host/scene/texture.h"

namespace mica::host {

/// A process of glints as one footprint sees it: where, and in which axes.
struct GlintPlace {
  Footprint footprint;
  /// Axes of the tangent plane, in which half vectors are given.
  Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  double microroughness = 0;
  GlintPoint point;
};

/// A material of glints without a map: their parameters at a point of a surface, and what D is multiplied
/// with. [Kem25]
class GlintMaterial {
 public:
  /// Throws FileError for a texture that cannot be used.
  explicit GlintMaterial(const MaterialDescription& material);

  /// The processes at a hit: one; two where a texture stretches glints, each step of the stretch being a
  /// process of its own; three planes of the world where there is no uv. Their shares add up to one.
  /// @param sigma_pixels standard deviation of the pixel filter.
  std::vector<GlintPlace> places(const CameraRay& ray, const Hit& hit, const TangentFrame& frame,
                                 double sigma_pixels) const;

  /// What D is multiplied with, besides the light's irradiance: Fresnel, masking and the texture of the
  /// reflection's colour.
  /// @param seen by the eye from the light.
  Color weight(const Hit& hit, const TangentFrame& frame, const LobesSeen& seen) const;

  /// Their lobe and colour at a place of the shape, where they are not told from each other.
  SmoothNormals from_afar(const Eigen::Vector2d& uv) const;

  /// Colour of the reflection by its texture.
  Color tint(const Eigen::Vector2d& uv) const;

  /// The microroughness at a place of the shape.
  double microroughness(const Eigen::Vector2d& uv) const;
  /// What a query asks with in its place: the light's extent widens it.
  double widened(double microroughness, const LobesSeen& seen) const;

 private:
  Eigen::Vector2d alpha_at(const Eigen::Vector2d& uv) const;
  void split_by_stretch(const Eigen::Vector2d& uv, std::vector<GlintPlace>* places) const;
  void split_by_plane(const CameraRay& ray, const Hit& hit, const TangentFrame& frame, double sigma_pixels,
                      std::vector<GlintPlace>* places) const;

  MaterialDescription material_;
  GlintsDescription glints_;
  std::optional<Texture> density_, alpha_, microroughness_, stretch_, color_;
};

}  // namespace mica::host
