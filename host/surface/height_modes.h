#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <functional>
#include <vector>

#include "host/base/constants.h"

/// Periodic heightfields from their Fourier modes.
namespace mica::host::synthesis {

/// Wave vector of the mode with m periods along u and n along v, radians a texel.
inline Eigen::Vector2d wave_vector(int resolution, int m, int n) {
  return 2 * kPi / resolution * Eigen::Vector2d(m, n);
}

/// Calls visit(m, n) for the modes that a real heightfield of `resolution` texels a side can have a slope of:
/// all of the lattice but the Nyquist ones, which have no partner of opposite sign. Columns of constant m run
/// in parallel.
void for_each_mode(int resolution, const std::function<void(int m, int n)>& visit);

/// Sum of quantity(m, n) over those modes; the same bits for any number of threads.
double sum_over_modes(int resolution, const std::function<double(int m, int n)>& quantity);

/// Uniform phase of a mode, opposite for the opposite mode, so that the height is real. A function of the
/// mode and not of the resolution: the same seed at twice the resolution keeps the shapes.
double phase(std::uint64_t seed, int m, int n);

/// Normals of the heightfield sum over m, n of H(m, n) exp(i k.x), x in texels from the corner texel's
/// centre.
/// @param height_mode H, texels; H(-m, -n) is the conjugate of H(m, n).
/// @return resolution^2 normals on the disk, row v near 0 first.
std::vector<Eigen::Vector2d> normals_of_modes(
    int resolution, const std::function<std::complex<double>(int m, int n)>& height_mode);

}  // namespace mica::host::synthesis
