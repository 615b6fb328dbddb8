#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host/surface/description.h"
#include "host/surface/extent.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Normals of a periodic Gaussian heightfield [Yan14 sec. 6, snail]; resolution^2, row v near 0 first.
///
/// The height's modes have the amplitudes of the power spectrum exp(-(k c)^2 / 4), that of an autocorrelation
/// of exp(-(d / c)^2) at distance d, and independent uniform phases. So the RMS slope over the texels is the
/// one asked for, exactly, and so is the autocorrelation, as far as the texels resolve it and the period
/// holds it. Throws UsageError when a setting is out of range: resolution 4..16384, rms_slope 0..5,
/// correlation_texels above 0 and at most the resolution. Warns where the texels or the period bends the
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

// The kinds below return normals, resolution^2, row v near 0 first, and throw UsageError when a setting is
// out of the range that its description gives.

/// Normals of a periodic Gaussian heightfield of autocorrelation exp(-(a / c_a)^2 - (b / c_b)^2) at distance
/// a along and b across the brushing. RMS slope and warnings as those of synthesise_spectrum.
std::vector<Eigen::Vector2d> synthesise_brushed(const BrushedSurface& brushed, SurfaceReport& report);

/// One scratch; heights are below 0 in its groove.
struct Scratch {
  Eigen::Vector2d center_texels;  ///< in [0, resolution)^2
  Eigen::Vector2d direction;      ///< unit
  double half_length, half_width, depth;
  double bend;  ///< how far its centre line bulges to the left of its direction, texels
  ScratchProfile profile;

  synthesis::Extent extent() const;
  /// Gradient of the height at `offset` texels from the centre; 0 outside.
  Eigen::Vector2d slope(const Eigen::Vector2d& offset) const;
};

/// Scratches at uniformly random places; as many as the density asks for at the mean length and width.
std::vector<Scratch> place_scratches(const ScratchesSurface& scratches);
std::vector<Eigen::Vector2d> synthesise_scratches(const ScratchesSurface& scratches, SurfaceReport& report);

/// A dent of height -depth (1 - d^2 / radius^2)^3 at distance d from its centre.
struct Dent {
  Eigen::Vector2d center_texels;  ///< in [0, resolution)^2
  double radius, depth;           ///< texels

  synthesis::Extent extent() const;
  Eigen::Vector2d slope(const Eigen::Vector2d& offset) const;
};

/// Dents at uniformly random places. E[p^2 + q^2] of their slopes is 1.2 density depth^2.
std::vector<Dent> place_dents(const DentsSurface& dents);
std::vector<Eigen::Vector2d> synthesise_dents(const DentsSurface& dents, SurfaceReport& report);

/// The cap of an ellipsoid whose cross section along its short axis is a circle.
struct Bump {
  Eigen::Vector2d center_texels;  ///< may lie outside [0, resolution)^2
  Eigen::Vector2d long_axis;      ///< unit
  double half_length, half_width;
  double squared_radius;  ///< squared radius of the ellipsoid, over that of the cap: 1 + 1 / slope^2

  synthesis::Extent extent() const;
  Eigen::Vector2d slope(const Eigen::Vector2d& offset) const;
};

/// One bump a cell of the lattice.
std::vector<Bump> place_bumps(const BumpsSurface& bumps);
std::vector<Eigen::Vector2d> synthesise_bumps(const BumpsSurface& bumps, SurfaceReport& report);

/// A wind sea: waves of the amplitudes of a directional Pierson-Moskowitz spectrum and of independent uniform
/// phases, which turn by the deep-water dispersion relation omega^2 = g k. Waves shorter than two texels are
/// left out. Warns when the patch is too small for the longest waves.
std::vector<Eigen::Vector2d> synthesise_waves(const WavesSurface& waves, SurfaceReport& report);

/// Density of the sea's height variance over wave vectors k, m^4: its integral over the plane is the
/// variance, m^2.
/// @param wave_vector radians a metre, along u and v.
double wave_spectrum(const WavesSurface& waves, const Eigen::Vector2d& wave_vector);

/// Variance of the height of the fully developed sea, m^2: the integral of wave_spectrum.
double wave_height_variance(double wind_speed);

/// Weighted sum of the layers' slopes. Throws UsageError when they differ in size, and what make_surface
/// throws.
Surface synthesise_layers(const LayersSurface& layers, Interpolation interpolation, SurfaceReport& report);

}  // namespace mica::host
