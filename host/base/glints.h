#pragma once

#include <cstdint>

#include "host/base/words.h"

namespace mica::host {

/// Smooth distribution of normals that glints add up to.
enum class Distribution { beckmann, trowbridge_reitz };

template <>
struct Words<Distribution> {
  static constexpr Word<Distribution> all[] = {{"ggx", Distribution::trowbridge_reitz},
                                               {"beckmann", Distribution::beckmann}};
};

/// What glints without a map are made of, at a point of a surface. [Kem25] Table 1. Single precision, because
/// every query of a picture carries one; single numbers are what the job says, rounded.
///
/// Several processes may share a surface: each takes its share of the light, and shares add up to one. Of a
/// process, only some glints may be there; they are as much brighter.
struct GlintPoint {
  Distribution distribution = Distribution::trowbridge_reitz;
  float alpha_x = 0.3F, alpha_y = 0.3F;  ///< roughness of the smooth distribution, 1e-4 to 1
  float density = 1e6F;                  ///< cells per unit area of uv, 1 to 1e12; pi/4 of them hold a glint
  float stretch = 1;  ///< how much longer each glint is along u, and its lobe along t; 1/64 to 64
  float share = 1;    ///< share of the light, (0, 1]
  float kept = 1;     ///< share of the glints that are there, [1/16, 1]
  std::uint32_t seed = 1;
};

}  // namespace mica::host
