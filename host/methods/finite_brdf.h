#pragma once

#include <memory>

#include "host/methods/patch_brdf.h"

namespace mica::host {

/// A BRDF whose answers that are not finite are 0, and counted (PatchBrdf::replaced): one query that a method
/// cannot answer does not lose the others of its batch, and adds no light.
std::unique_ptr<PatchBrdf> with_finite_answers(std::unique_ptr<PatchBrdf> brdf);

}  // namespace mica::host
