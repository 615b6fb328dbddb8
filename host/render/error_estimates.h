#pragma once

#include <vector>

#include "host/render/built_job.h"

namespace mica::host {

/// How far each of the rows' densities may be off, by query: that of `auto` by what its calibration measured
/// at 95% confidence, that of `triangles` by its promise. Plans with other evaluators
/// have no channel for them.
std::vector<float> estimate_errors(const BuiltJob& built, const TracedRows& rows,
                                   const std::vector<float>& densities);

}  // namespace mica::host
