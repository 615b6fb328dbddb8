#pragma once

#include "host/base/words.h"

namespace mica::host {

/// Where the light goes that bounces more than once inside V-shaped cavities: f_2+. [Che19] secs. 3.5 and 5.2
enum class Compensation {
  diffuse,  ///< in all directions alike
  specular  ///< about the mirror image in the geometric normal, blurred like the facets
};

/// Where the energy comes from that one bounce loses under a footprint.
enum class LostEnergy {
  exact,   ///< every seed under the footprint. [Che19] Eq. 15
  sampled  ///< some of them: one in each cell of a lattice
};

template <>
struct Words<Compensation> {
  static constexpr Word<Compensation> all[] = {{"diffuse", Compensation::diffuse},
                                               {"specular", Compensation::specular}};
};

template <>
struct Words<LostEnergy> {
  static constexpr Word<LostEnergy> all[] = {{"exact", LostEnergy::exact}, {"sampled", LostEnergy::sampled}};
  static constexpr Word<LostEnergy> former[] = {{"table", LostEnergy::sampled}};
};

}  // namespace mica::host
