#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mica::host::synthesis {

/// Normals of a periodic Gaussian heightfield of autocorrelation exp(-d^T C^-1 d) at offset d.
///
/// Its modes have the amplitudes of the power spectrum exp(-k^T C k / 4) and independent uniform phases, so
/// that the RMS slope over the texels is the one asked for, exactly.
/// @param squared_correlation C, texels^2, symmetric and positive definite.
/// @return resolution^2 normals on the disk, row v near 0 first.
std::vector<Eigen::Vector2d> gaussian_heightfield(int resolution, double rms_slope,
                                                  const Eigen::Matrix2d& squared_correlation,
                                                  std::uint64_t seed);

}  // namespace mica::host::synthesis
