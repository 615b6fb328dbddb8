#pragma once

#include <vector>

namespace mica::host {

/// What leaves V-shaped cavities after one bounce, E_1, where the slopes of their facets are an isotropic
/// Gaussian about 0: a table over their roughness and the view's polar angle, filled by quadrature. [Che19]
/// Eq. 18 and Fig. 7
class EnergyTable {
 public:
  static constexpr int kSide = 128;  ///< entries each way
  static constexpr double kMaxAlpha = 15;

  EnergyTable();

  /// Interpolated; within 2e-3 of `mean_cavity_energy`.
  /// @param alpha Beckmann roughness: sqrt(2) standard deviations of the slope along an axis. Larger ones
  /// count as kMaxAlpha. @param cosine of the view, in (0, 1].
  double energy(double alpha, double cosine) const;

 private:
  std::vector<float> entries_;  // row by row of constant alpha
};

/// E_1 averaged over facets with Gaussian slopes, to 1e-5.
double mean_cavity_energy(double alpha, double cosine);

}  // namespace mica::host
