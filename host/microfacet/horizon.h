#pragma once

namespace mica::host {

/// Directions closer to the horizon of a surface than this cosine neither see nor light it.
constexpr double kMinCosine = 1e-6;

}  // namespace mica::host
