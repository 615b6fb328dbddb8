#pragma once

#include <cstdint>

#include "host/scene/hit.h"
#include "host/scene/scene.h"

namespace mica::host {

constexpr double kFar = std::numeric_limits<double>::infinity();  ///< as far as a ray goes

/// Radiance that the scene's shapes send back along `ray`; zero when it hits nothing. Light is followed over
/// at most `bounces` reflections, by the smooth lobes of the materials [Che19 sec. 5]: from the second
/// reflection on glints are too blurred to be worth their footprints.
/// @param key all random numbers are a hash of it.
Color surface_light(const Scene& scene, Ray ray, int bounces, std::uint64_t key);

}  // namespace mica::host
