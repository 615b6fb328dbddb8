#pragma once

#include <cstddef>
#include <functional>

#include "host/render/built_job.h"

namespace mica::host {

/// Adds to `rows->sample_radiance` what the materials reflect of the light from all around and of other
/// surfaces, and empties `rows->points`.
///
/// At each footprint ImageSettings::samples directions are drawn by where the light comes from, and as many
/// by where the material reflects it to; both estimate the same integral, and each is weighted by its share
/// of the density with which the two together draw its direction: the balance heuristic of E. Veach, "Robust
/// Monte Carlo Methods for Light Transport Simulation" (1997), sec. 9.2.2. The diffuse lobe has a pair of its
/// own. The random numbers are a hash of the job's seed, the frame, the pixel, the subpixel and the sample.
///
/// @return how many questions the materials' BRDFs answered.
std::size_t gather_light(const BuiltJob& built, TracedRows* rows);

/// Told of each light and what its BRDF answered, in their order.
using SeeLitBrdf = std::function<void(const LitBrdf& lit, const BrdfValue& value)>;

/// Adds to `rows->sample_radiance` the lights of `rows->lit`, and empties it. @return how many they were.
std::size_t add_lit_brdfs(const BuiltJob& built, TracedRows* rows, const SeeLitBrdf& see = {});

}  // namespace mica::host
