#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/surface/surface.h"

namespace mica::host {

/// Between a half float and the next one.
double half_float_step(double number);

/// Normals between those that steps tell, where neighbours tell them; see restore_steps.
/// @param step of s on the disk. @param normals row by row, changed by half a step at most.
void restore_normals(int width, int height, double step, std::vector<Eigen::Vector2d>* normals);

/// By how much P-NDFs of a surface are off because its file tells normals in steps, as its own texels say:
/// the relative L2, at a roughness and under footprints of 24 texels, between it and a surface that rounds to
/// it. That one is restored where texels are smooth, and elsewhere has other normals within half a step, the
/// same on a facet of equal texels. 0 without steps.
double precision_error(const Surface& surface, double roughness);

/// Returns that error, and says it where it is a thousandth or more: as a warning from 5% on, with what may
/// help.
/// @param roughness the smallest that is asked of the surface.
double report_precision(const Surface& surface, double roughness, Findings* findings);

}  // namespace mica::host
