#pragma once

#include <vector>

#include "host/scene/scene.h"

namespace mica::host {

/// Adds to `radiance`, a pixel, what fitted ones see of samples: of the lamps that have edges there.
/// @param densities in the order of the rows' queries.
void add_lamp_samples(const TracedRows& rows, const std::vector<float>& densities,
                      std::vector<Eigen::Vector3d>* radiance);

}  // namespace mica::host
