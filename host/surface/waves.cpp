#include <fmt/format.h>

#include <cmath>

#include "host/surface/height_modes.h"
#include "host/surface/settings.h"
#include "host/surface/synthesis.h"

namespace mica::host {
namespace {

// Pierson and Moskowitz, "A proposed spectral form for fully developed wind seas", J. Geophys. Res. 69(24),
// 1964: S(omega) = alpha g^2 / omega^5 exp(-beta (omega_0 / omega)^4) with omega_0 = g / U, U the wind speed
// at 19.5 m.
constexpr double kGravity = 9.81;  // m / s^2
constexpr double kAlpha = 8.1e-3, kBeta = 0.74;

constexpr double kLeast = 1e-6;  // settings that are above 0 are at least this
constexpr double kEnoughVariance =
    0.9;  // share of the sea's; less, and its longest waves are missing visibly

void check(const WavesSurface& waves) {
  synthesis::check_resolution("waves", waves.resolution);
  synthesis::check_setting("waves", "patch in metres", waves.patch_meters, kLeast, 1e6);
  synthesis::check_setting("waves", "wind speed in metres a second", waves.wind_speed, kLeast, 100);
  synthesis::check_setting("waves", "wind direction in degrees", waves.wind_direction_degrees, -360, 360);
  synthesis::check_setting("waves", "time in seconds", waves.time_seconds, -1e6, 1e6);
}

Eigen::Vector2d wind_direction(const WavesSurface& waves) {
  const double angle = waves.wind_direction_degrees * kPi / 180;
  return {std::cos(angle), std::sin(angle)};
}

/// Wave vector of the mode with m and n waves over the patch, radians a metre.
Eigen::Vector2d wave_vector(const WavesSurface& waves, int m, int n) {
  return 2 * kPi / waves.patch_meters * Eigen::Vector2d(m, n);
}

/// Share of the sea's height variance that the map's modes hold.
double share_of_variance(const WavesSurface& waves) {
  const double cell =
      std::pow(2 * kPi / waves.patch_meters, 2);  // area of wave vectors that a mode stands for
  const double variance = synthesis::sum_over_modes(
      waves.resolution, [&](int m, int n) { return cell * wave_spectrum(waves, wave_vector(waves, m, n)); });
  return variance / wave_height_variance(waves.wind_speed);
}

}  // namespace

double wave_spectrum(const WavesSurface& waves, const Eigen::Vector2d& wave_vector) {
  const double k = wave_vector.norm();
  const double downwind = wave_vector.dot(wind_direction(waves)) / k;  // cosine
  if (!(k > 0 && downwind > 0)) return 0;
  const double omega = std::sqrt(kGravity * k), omega_0 = kGravity / waves.wind_speed;
  const double frequency_spectrum =
      kAlpha * kGravity * kGravity / std::pow(omega, 5) * std::exp(-kBeta * std::pow(omega_0 / omega, 4));
  // The spreading of [Pierson, Neumann, James 1955], which lets no wave run against the wind: then each has
  // one direction, and an amplitude that does not change with time.
  const double spreading = 2 / kPi * downwind * downwind;
  const double jacobian = kGravity / (2 * omega) / k;  // d omega d theta by dk
  return frequency_spectrum * spreading * jacobian;
}

double wave_height_variance(double wind_speed) {
  return kAlpha * std::pow(wind_speed, 4) / (4 * kBeta * kGravity * kGravity);
}

std::vector<Eigen::Vector2d> synthesise_waves(const WavesSurface& waves, SurfaceReport& report) {
  check(waves);
  const double share = share_of_variance(waves);
  const double significant_height = 4 * std::sqrt(wave_height_variance(waves.wind_speed));
  report.notes.push_back(fmt::format("waves: {:.3g} m significant wave height, {:.3g} m between texels",
                                     significant_height, waves.patch_meters / waves.resolution));
  if (share < kEnoughVariance) {
    report.warnings.push_back(
        fmt::format("waves: a patch of {} m holds {:.0f}% of the height variance of this sea; its longest "
                    "waves are missing",
                    waves.patch_meters, 100 * share));
  }
  const double texel_meters = waves.patch_meters / waves.resolution;
  return synthesis::normals_of_modes(waves.resolution, [&](int m, int n) -> std::complex<double> {
    const Eigen::Vector2d k = wave_vector(waves, m, n);
    // A wave a cos(k.x - omega t + phase) is two modes of a / 2; a^2 / 2 is its share of the variance.
    const bool runs_downwind = k.dot(wind_direction(waves)) > 0;
    const double density = wave_spectrum(waves, runs_downwind ? k : Eigen::Vector2d(-k));
    const double amplitude_meters = 2 * kPi / waves.patch_meters * std::sqrt(2 * density);
    const double turn = std::sqrt(kGravity * k.norm()) * waves.time_seconds;
    return std::polar(amplitude_meters / 2 / texel_meters,
                      synthesis::phase(waves.seed, m, n) + (runs_downwind ? -turn : turn));
  });
}

}  // namespace mica::host
