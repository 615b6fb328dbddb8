#pragma once

#include "host/scene/description.h"
#include "host/scene/mesh.h"

namespace mica::host {

/// A round jar, part "body", and its lid with a knob, part "lid". u runs around both, v along their outline
/// from the bottom up, both in units of the body's circumference: texels are square on the body, and a map is
/// seamless when `repeat` is a whole number in u. On the lid brushing along u is that of a lathe.
/// Throws UsageError unless size is positive.
TriangleMesh make_jar(const JarShape& jar);

}  // namespace mica::host
