#pragma once

#include <array>
#include <complex>
#include <vector>

namespace mica::host {

/// Two numbers a texel of a square, u + i v, row by row.
using PairGrid = std::vector<std::complex<float>>;

/// Filters that change over a periodic square: windows that overlap by half are weighted by a sine on the way
/// in and on the way out [Princen and Bradley 1986], and each has gains of its own.
class LocalFilter {
 public:
  static constexpr int kWindow = 64, kHop = kWindow / 2;  // texels a side

  /// Of u and v, window by window, frequency by frequency.
  using Gains = std::vector<std::array<float, 2>>;

  /// @param side of the square; a multiple of kHop, at least kWindow.
  explicit LocalFilter(int side) : side_(side), windows_(side / kHop) {}

  /// Powers of white noise are its variance. Planes are taken from windows before; smoothed over neighbouring
  /// windows and frequencies.
  Gains powers(const PairGrid& grid) const;

  /// A window's plane has the gain of its frequency 0.
  PairGrid filtered(const PairGrid& grid, const Gains& gains) const;

  int windows() const { return windows_ * windows_; }

 private:
  int side_, windows_;  ///< texels and windows along a side
};

}  // namespace mica::host
