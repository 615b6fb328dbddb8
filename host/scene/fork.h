#pragma once

#include "host/scene/description.h"
#include "host/scene/mesh.h"

namespace mica::host {

/// A table fork of four tines. Texture coordinates as those of the spoon. Throws UsageError unless size is
/// positive.
TriangleMesh make_fork(const ForkShape& fork);

}  // namespace mica::host
