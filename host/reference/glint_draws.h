#pragma once

#include "host/reference/glint_grid.h"

namespace mica::host::reference {

/// Density over the disk (s, t) with which half vectors are drawn from a process, as
/// kernels/grid/grid_brdf.cl says it in words, in double precision. [Kem25] sec. 3.3.5. The process has no
/// share and keeps all its glints.
double glint_draw_density(const GlintProcess& process, const Query& query);

}  // namespace mica::host::reference
