#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host/surface/description.h"
#include "host/surface/surface.h"

namespace mica {

/// Normals of a periodic Gaussian heightfield [Yan14 sec. 6, snail]; resolution^2, row v near 0 first.
///
/// The height's modes have the amplitudes of the power spectrum exp(-(k c)^2 / 4), that of an autocorrelation
/// of exp(-(d / c)^2) at distance d, and independent uniform phases. So the RMS slope over the texels is the
/// one asked for, exactly, and so is the autocorrelation, as far as the grid resolves it and the period holds
/// it. Throws UsageError when a setting is out of range: resolution 4..16384, rms_slope 0..5,
/// correlation_texels above 0 and at most the resolution. Warns where the grid or the period bends the
/// autocorrelation.
std::vector<Eigen::Vector2d> synthesise_spectrum(const SpectrumSurface& spectrum, SurfaceReport& report);

/// Metallic flakes: which flake each texel belongs to, and where the flakes are.
struct Flakes {
  std::vector<Eigen::Vector2d> centers_texels;  ///< in [0, resolution)^2
  std::vector<Eigen::Vector2d> normals;         ///< one a flake, on the unit disk
  std::vector<std::uint32_t> flake_of_texel;    ///< resolution^2, row v near 0 first

  std::vector<Eigen::Vector2d> texel_normals() const;
};

/// Voronoi cells of Poisson-disk centres on the torus, one Beckmann-distributed normal a cell [Yan14 sec. 6,
/// paint]. Texels belong to the centre nearest to theirs. The normals' density over the disk is Beckmann's D:
/// slopes are Gaussian with a variance of alpha^2 / 2 an axis. Throws UsageError when a setting is out of
/// range: resolution 8..16384, flake_size_texels 2..resolution / 4, alpha 0..2.
Flakes synthesise_flakes(const FlakesSurface& flakes, SurfaceReport& report);

}  // namespace mica
