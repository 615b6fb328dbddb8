#include "host/surface/height_modes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <numeric>
#include <unsupported/Eigen/FFT>

#include "host/base/random.h"
#include "host/surface/disk.h"

namespace mica::host::synthesis {
namespace {

/// Index of `periods` in a discrete Fourier transform.
int index_of(int resolution, int periods) {
  return periods < 0 ? periods + resolution : periods;
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

void for_each_mode(int resolution, const std::function<void(int, int)>& visit) {
  const int highest = (resolution - 1) / 2;
  tbb::parallel_for(-highest, highest + 1, [&](int m) {
    for (int n = -highest; n <= highest; ++n) visit(m, n);
  });
}

double sum_over_modes(int resolution, const std::function<double(int, int)>& quantity) {
  std::vector<double> columns(static_cast<std::size_t>(resolution), 0.0);
  for_each_mode(resolution, [&](int m, int n) { columns[index_of(resolution, m)] += quantity(m, n); });
  return std::accumulate(columns.begin(), columns.end(), 0.0);
}

double phase(std::uint64_t seed, int m, int n) {
  const bool mirrored = n < 0 || (n == 0 && m < 0);
  if (mirrored) m = -m, n = -n;
  const double angle = 2 * kPi *
                       random_unit(seed, static_cast<std::uint64_t>(n),
                                   static_cast<std::uint64_t>(static_cast<std::int64_t>(m)));
  return mirrored ? -angle : angle;
}

std::vector<Eigen::Vector2d> normals_of_modes(
    int resolution, const std::function<std::complex<double>(int, int)>& height_mode) {
  // Fourier transform of p + i q, the slopes along u and v: differentiation multiplies by i k; p and q are
  // real, so one complex transform carries both. Element (index along v, index along u).
  Eigen::MatrixXcd slopes = Eigen::MatrixXcd::Zero(resolution, resolution);
  for_each_mode(resolution, [&](int m, int n) {
    const Eigen::Vector2d k = wave_vector(resolution, m, n);
    slopes(index_of(resolution, n), index_of(resolution, m)) =
        std::complex<double>(-k.y(), k.x()) * height_mode(m, n);
  });
  inverse_transform_columns(slopes);  // along v
  slopes.transposeInPlace();
  inverse_transform_columns(slopes);  // along u; element (i, j) is now texel (i, j), and i runs fastest

  std::vector<Eigen::Vector2d> normals(static_cast<std::size_t>(slopes.size()));
  tbb::parallel_for(std::size_t{0}, normals.size(), [&](std::size_t texel) {
    const std::complex<double> slope = slopes.data()[texel];
    normals[texel] = disk_from_slope({slope.real(), slope.imag()});
  });
  return normals;
}

}  // namespace mica::host::synthesis
