#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/description.h"
#include "host/scene/geometry.h"

namespace mica::host {

/// Indices of the materials of each shape's parts.
using PartMaterials = std::vector<std::vector<std::uint32_t>>;

/// Throws UsageError for a part or a material that is not there.
PartMaterials materials_of_parts(const SceneDescription& description, const Geometry& geometry);

}  // namespace mica::host
