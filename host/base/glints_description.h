#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/glints.h"

namespace mica::host {

/// Files of images that multiply a parameter of glints over the shape's uv; empty: nothing does.
struct GlintTextures {
  std::string density;         ///< first channel, as all but the colour
  std::string alpha;           ///< both roughnesses of the smooth distribution
  std::string microroughness;  ///< roughness of a single glint
  std::string stretch;         ///< exponent: 0 leaves glints round, 1 stretches them as the material says
  std::string color;           ///< colour of the reflection
};

/// A material with `ndf = "grid"`: glints without a map. [Kem25] Table 1. Microroughness is the material's
/// roughness.
struct GlintsDescription {
  enum class Mapping { uv, triplanar };
  enum class Masking { smith, cavity };

  Distribution distribution = Distribution::trowbridge_reitz;
  Eigen::Vector2d alpha{0.3, 0.3};  ///< roughness of the smooth distribution, along u and v
  double density = 1e6;  ///< cells per unit area of repeated uv; triplanar: of repeated world units
  double stretch = 1;    ///< how much longer each glint is along u
  std::uint32_t seed = 1;
  Mapping mapping = Mapping::uv;
  Masking masking = Masking::smith;
  std::vector<Eigen::Vector3d> colors;  ///< each glint has one of them, at random; none: all are white
  GlintTextures textures;
};

template <>
struct Words<GlintsDescription::Mapping> {
  static constexpr Word<GlintsDescription::Mapping> all[] = {
      {"uv", GlintsDescription::Mapping::uv}, {"triplanar", GlintsDescription::Mapping::triplanar}};
};

template <>
struct Words<GlintsDescription::Masking> {
  static constexpr Word<GlintsDescription::Masking> all[] = {{"smith", GlintsDescription::Masking::smith},
                                                             {"cavity", GlintsDescription::Masking::cavity}};
};

}  // namespace mica::host
