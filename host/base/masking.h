#pragma once

#include "host/base/words.h"

namespace mica::host {

/// Where a patch BRDF's masking and projected areas come from.
enum class Masking {
  exact,     ///< every lobe under the footprint. [Che18] Eqs. 10-17
  filtered,  ///< one lobe that has the moments of the footprint's slopes. [Che18] sec. 4.2.2
  geometric  ///< one roughness for the whole map, and cosines to the geometric normal. [Yan14] Eq. 1
};

/// Whether a patch BRDF may scatter more than it gets where its masking is an approximation.
enum class EnergyBound {
  none,
  patch  ///< every direction sees at least what the lobes under the footprint show it
};

template <>
struct Words<EnergyBound> {
  static constexpr Word<EnergyBound> all[] = {{"none", EnergyBound::none}, {"patch", EnergyBound::patch}};
};

template <>
struct Words<Masking> {
  static constexpr Word<Masking> all[] = {
      {"exact", Masking::exact}, {"filtered", Masking::filtered}, {"geometric", Masking::geometric}};
};

}  // namespace mica::host
