#include "host/surface/local_filter.h"

#include <cmath>
#include <unsupported/Eigen/FFT>

#include "host/base/constants.h"

namespace mica::host {
namespace {

constexpr int kWindow = LocalFilter::kWindow, kHop = LocalFilter::kHop, kTexels = kWindow * kWindow;

using Complex = std::complex<float>;

/// One window's texels or frequencies.
class Window {
 public:
  Window() : values_(kTexels), line_(kWindow), found_(kWindow) {
    fft_.SetFlag(Eigen::FFT<float>::Unscaled);
    for (int n = 0; n < kWindow; ++n) weights_[n] = static_cast<float>(std::sin(kPi * (n + 0.5) / kWindow));
  }

  /// Reads a window, its plane apart, and transforms it.
  void read(const PairGrid& grid, int side, int first_i, int first_j) {
    middle_ = along_u_ = along_v_ = 0;
    float squares = 0;
    for (int j = 0; j < kWindow; ++j)
      for (int i = 0; i < kWindow; ++i) {
        const Complex value =
            grid[static_cast<std::size_t>((first_j + j) % side) * side + (first_i + i) % side];
        values_[j * kWindow + i] = value;
        middle_ += value, along_u_ += from_middle(i) * value, along_v_ += from_middle(j) * value;
        squares += from_middle(i) * from_middle(i);
      }
    middle_ /= kTexels, along_u_ /= squares, along_v_ /= squares;
    for (int j = 0; j < kWindow; ++j)
      for (int i = 0; i < kWindow; ++i) {
        Complex& value = values_[j * kWindow + i];
        value = weights_[i] * weights_[j] * (value - plane(i, j));
      }
    transform(false);
  }

  void add_to(PairGrid* grid, int side, int first_i, int first_j) {
    transform(true);
    for (int j = 0; j < kWindow; ++j)
      for (int i = 0; i < kWindow; ++i) {
        const float weight = weights_[i] * weights_[j];
        const Complex value = values_[j * kWindow + i] / static_cast<float>(kTexels) + weight * plane(i, j);
        (*grid)[static_cast<std::size_t>((first_j + j) % side) * side + (first_i + i) % side] +=
            weight * value;
      }
  }

  /// Spectra of u and v, from that of u + i v.
  std::array<Complex, 2> at(int k) const {
    const Complex own = values_[k], other = std::conj(values_[opposite(k)]);
    return {0.5f * (own + other), Complex(0, -0.5f) * (own - other)};
  }
  void multiply(const std::array<float, 2>* gains) {
    for (int k = 0; k < kTexels; ++k) {
      const auto [u, v] = at(k);
      products_[k] = gains[k][0] * u + Complex(0, gains[k][1]) * v;
    }
    values_.swap(products_);
    for (Complex* part : {&middle_, &along_u_, &along_v_})
      *part = {gains[0][0] * part->real(), gains[0][1] * part->imag()};
  }

 private:
  static float from_middle(int n) { return static_cast<float>(n) - 0.5f * (kWindow - 1); }
  static int opposite(int k) {
    return (kWindow - k / kWindow) % kWindow * kWindow + (kWindow - k % kWindow) % kWindow;
  }
  Complex plane(int i, int j) const {
    return middle_ + from_middle(i) * along_u_ + from_middle(j) * along_v_;
  }

  void transform(bool inverse) {
    for (const bool columns : {false, true})
      for (int n = 0; n < kWindow; ++n) {
        const int first = columns ? n : n * kWindow, stride = columns ? kWindow : 1;
        for (int m = 0; m < kWindow; ++m) line_[m] = values_[first + m * stride];
        inverse ? fft_.inv(found_.data(), line_.data(), kWindow)
                : fft_.fwd(found_.data(), line_.data(), kWindow);
        for (int m = 0; m < kWindow; ++m) values_[first + m * stride] = found_[m];
      }
  }

  Eigen::FFT<float> fft_;
  std::array<float, kWindow> weights_;
  PairGrid values_, line_, found_, products_ = PairGrid(kTexels);
  Complex middle_, along_u_, along_v_;
};

/// Means with both neighbours, wrapped: weights 1, 2, 1 over frequencies, 1, 1, 1 over windows.
void smooth(int count, int stride, float own_weight, float* values) {
  std::vector<float> line(static_cast<std::size_t>(count));
  for (int n = 0; n < count; ++n) line[n] = values[n * stride];
  for (int n = 0; n < count; ++n)
    values[n * stride] =
        (line[(n + count - 1) % count] + own_weight * line[n] + line[(n + 1) % count]) / (2 + own_weight);
}

void smooth_powers(int windows, LocalFilter::Gains* powers) {
  float* const first = powers->front().data();
  for (int axis = 0; axis < 2; ++axis) {
    for (int window = 0; window < windows * windows; ++window)
      for (int n = 0; n < kWindow; ++n) {
        float* const of_window = first + 2 * window * kTexels + axis;
        smooth(kWindow, 2, 2, of_window + 2 * n * kWindow);
      }
    for (int window = 0; window < windows * windows; ++window)
      for (int n = 0; n < kWindow; ++n)
        smooth(kWindow, 2 * kWindow, 2, first + 2 * window * kTexels + axis + 2 * n);
    for (int n = 0; n < windows; ++n)
      for (int k = 0; k < kTexels; ++k)
        smooth(windows, 2 * kTexels, 1, first + 2 * (n * windows * kTexels + k) + axis);
    for (int n = 0; n < windows; ++n)
      for (int k = 0; k < kTexels; ++k)
        smooth(windows, 2 * kTexels * windows, 1, first + 2 * (n * kTexels + k) + axis);
  }
}

}  // namespace

LocalFilter::Gains LocalFilter::powers(const PairGrid& grid) const {
  constexpr float of_weights = 0.25f * kTexels;  // sum of their squares
  Gains powers(static_cast<std::size_t>(windows_) * windows_ * kTexels);
  Window window;
  for (int n = 0; n < windows_ * windows_; ++n) {
    window.read(grid, side_, n % windows_ * kHop, n / windows_ * kHop);
    for (int k = 0; k < kTexels; ++k) {
      const auto [u, v] = window.at(k);
      powers[static_cast<std::size_t>(n) * kTexels + k] = {std::norm(u) / of_weights,
                                                           std::norm(v) / of_weights};
    }
  }
  smooth_powers(windows_, &powers);
  return powers;
}

PairGrid LocalFilter::filtered(const PairGrid& grid, const Gains& gains) const {
  PairGrid sum(grid.size());
  Window window;
  for (int n = 0; n < windows_ * windows_; ++n) {
    const int i = n % windows_ * kHop, j = n / windows_ * kHop;
    window.read(grid, side_, i, j);
    window.multiply(&gains[static_cast<std::size_t>(n) * kTexels]);
    window.add_to(&sum, side_, i, j);
  }
  return sum;
}

}  // namespace mica::host
