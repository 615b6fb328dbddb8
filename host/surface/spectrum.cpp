#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "host/base/error.h"
#include "host/surface/disk.h"
#include "host/surface/random.h"
#include "host/surface/synthesis.h"

namespace mica {
namespace {

constexpr double kPi = 3.14159265358979323846;

void check(const SpectrumSurface& spectrum) {
  if (spectrum.resolution < 4 || spectrum.resolution > 16384) {
    throw UsageError(
        fmt::format("spectrum: resolution is {}, expected 4 to 16384 texels", spectrum.resolution));
  }
  if (!(spectrum.rms_slope >= 0 && spectrum.rms_slope <= 5)) {
    throw UsageError(fmt::format("spectrum: rms_slope is {}, expected 0 to 5", spectrum.rms_slope));
  }
  if (!(spectrum.correlation_texels > 0 && spectrum.correlation_texels <= spectrum.resolution)) {
    throw UsageError(
        fmt::format("spectrum: correlation is {} texels, expected above 0 and at most the resolution ({})",
                    spectrum.correlation_texels, spectrum.resolution));
  }
}

/// One axis of the separable power spectrum, by the index of the discrete Fourier transform.
struct Axis {
  std::vector<int> periods;           ///< over the map, signed
  std::vector<double> wave_number;    ///< k, radians a texel
  std::vector<double> amplitude;      ///< square root of the power exp(-(k c)^2 / 4)
  double power = 0, slope_power = 0;  ///< sums of the power and of k^2 times the power

  explicit Axis(const SpectrumSurface& spectrum) {
    const int size = spectrum.resolution;
    for (int index = 0; index < size; ++index) {
      const int n = 2 * index < size ? index : index - size;
      const double k = 2 * kPi * n / size, kc = k * spectrum.correlation_texels;
      // The Nyquist mode has no partner of opposite sign: a real heightfield cannot give it a slope.
      const double root = 2 * index == size ? 0.0 : std::exp(-kc * kc / 8);
      periods.push_back(n);
      wave_number.push_back(k);
      amplitude.push_back(root);
      power += root * root;
      slope_power += k * k * root * root;
    }
  }
};

/// Uniform phase of a mode, opposite for the opposite mode, so that the height is real. A function of the
/// mode and not of the resolution: the same seed at twice the resolution keeps the shapes.
double phase(std::uint64_t seed, long m, long n) {
  const bool mirrored = n < 0 || (n == 0 && m < 0);
  if (mirrored) m = -m, n = -n;
  const double angle =
      2 * kPi * synthesis::random_unit(seed, static_cast<std::uint64_t>(n), static_cast<std::uint64_t>(m));
  return mirrored ? -angle : angle;
}

/// Fourier transform of p + i q, the slopes along u and v; element (index along v, index along u).
Eigen::MatrixXcd slope_modes(const SpectrumSurface& spectrum) {
  const Axis axis(spectrum);
  // Parseval: E[p^2 + q^2] is the sum of k^2 |H|^2 over all modes, and the power spectrum is separable.
  const double scale = spectrum.rms_slope / std::sqrt(2 * axis.power * axis.slope_power);
  const int size = spectrum.resolution;
  Eigen::MatrixXcd modes(size, size);
  tbb::parallel_for(0, size, [&](int column) {
    for (int row = 0; row < size; ++row) {
      const std::complex<double> height =
          std::polar(scale * axis.amplitude[column] * axis.amplitude[row],
                     phase(spectrum.seed, axis.periods[column], axis.periods[row]));
      // Differentiation multiplies by i k; p and q are real, so one complex transform carries both.
      modes(row, column) = std::complex<double>(-axis.wave_number[row], axis.wave_number[column]) * height;
    }
  });
  return modes;
}

void inverse_transform_columns(Eigen::MatrixXcd& matrix) {
  const int columns_a_plan = 32;  // a plan's tables cost about as much as one transform
  tbb::parallel_for(tbb::blocked_range<Eigen::Index>(0, matrix.cols(), columns_a_plan),
                    [&](const auto& range) {
                      Eigen::FFT<double> fft;
                      fft.SetFlag(Eigen::FFT<double>::Unscaled);
                      Eigen::VectorXcd source(matrix.rows());
                      for (Eigen::Index column = range.begin(); column < range.end(); ++column) {
                        source = matrix.col(column);
                        fft.inv(matrix.col(column).data(), source.data(), matrix.rows());
                      }
                    });
}

}  // namespace

std::vector<Eigen::Vector2d> synthesise_spectrum(const SpectrumSurface& spectrum, SurfaceReport& report) {
  check(spectrum);
  if (spectrum.correlation_texels < 2) {
    report.warnings.push_back(
        fmt::format("spectrum: a correlation of {} texels is finer than the grid resolves; the map's is "
                    "longer (use 2 or more)",
                    spectrum.correlation_texels));
  }
  if (4 * spectrum.correlation_texels > spectrum.resolution) {
    report.warnings.push_back(fmt::format(
        "spectrum: a correlation of {} texels leaves few features in a period of {}; the map's is shorter",
        spectrum.correlation_texels, spectrum.resolution));
  }
  Eigen::MatrixXcd slopes = slope_modes(spectrum);
  inverse_transform_columns(slopes);  // along v
  slopes.transposeInPlace();
  inverse_transform_columns(
      slopes);  // along u; element (i, j) is now texel (i, j), and i runs fastest in memory

  std::vector<Eigen::Vector2d> normals(static_cast<std::size_t>(slopes.size()));
  tbb::parallel_for(std::size_t{0}, normals.size(), [&](std::size_t texel) {
    const std::complex<double> slope = slopes.data()[texel];
    normals[texel] = disk_from_slope({slope.real(), slope.imag()});
  });
  return normals;
}

}  // namespace mica
