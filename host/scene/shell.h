#pragma once

#include "host/scene/description.h"
#include "host/scene/mesh.h"

namespace mica::host {

/// A snail shell: a circle that grows by a constant factor a turn while it winds about an axis [Raup66], with
/// a rounded apex and a lip that turns inwards, so that the surface is closed. The axis leans; the bounding
/// box of the result stands on z = center.z, its middle above center, `size` high.
///
/// v runs once around the tube. u runs along it from the apex, one unit as long on the outer side as the tube
/// is around there: the surface is similar to itself, so texels keep their shape everywhere, and are as much
/// smaller on an inner whorl as the whorl is. The map is seamless around the tube when `repeat` is a whole
/// number in v.
///
/// [Raup66]: David M. Raup, "Geometric Analysis of Shell Coiling", Journal of Paleontology 40(5), 1966.
/// Throws UsageError unless size is positive and 1 <= turns <= 12.
TriangleMesh make_shell(const ShellShape& shell);

}  // namespace mica::host
