#pragma once

#include "host/scene/description.h"
#include "host/scene/mesh.h"

namespace mica::host {

/// A table spoon. Texture coordinates are (x, y) over its length, from its middle: brushing along u runs
/// along the spoon. Throws UsageError unless size is positive.
TriangleMesh make_spoon(const SpoonShape& spoon);

}  // namespace mica::host
