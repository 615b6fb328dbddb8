#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "host/base/query.h"
#include "host/scene/description.h"
#include "host/scene/hit.h"
#include "host/scene/shading.h"

namespace mica::host {

/// A footprint that gathers light from all around, about a sample.
struct LitPoint {
  Hit hit;
  TangentFrame frame;
  Eigen::Vector3d to_eye;      ///< unit
  Footprint footprint;         ///< in the map's uv
  std::uint64_t key = 0;       ///< a number for the pixel that it lies in: of the image, row * width + column
  std::uint32_t sample = 0;    ///< of the lattice
  std::uint32_t subpixel = 0;  ///< in its pixel
  std::uint32_t material = 0;  ///< index into SceneDescription::materials
  double roughness = 0;        ///< of its queries
  Color tint = Color::Ones();  ///< of all that a P-NDF mirrors
  /// Glints without a map may be several processes, with an own footprint and frame, that share the light.
  /// The first one has the light of the material's other lobes.
  std::optional<GlintPoint> glints = {};
  std::uint32_t process = 0;
};

/// A light seen in a footprint whose material is a patch BRDF, with what its two parts are multiplied with.
struct LitBrdf {
  BrdfQuery query;
  std::uint32_t pixel = 0, sample = 0;  ///< as of a GlintQuery
  std::uint32_t material = 0;
  Eigen::Vector3f weight_single = Eigen::Vector3f::Zero();    ///< radiance into the sample per unit of it
  Eigen::Vector3f weight_multiple = Eigen::Vector3f::Zero();  ///< the same of light that bounced more often
};

}  // namespace mica::host
