#include "host/microfacet/masking.h"

#include <cmath>

namespace mica::host {

double beckmann_lambda(double cos_theta, double alpha) {
  const double alpha_tan = alpha * std::sqrt(std::fmax(0, 1 - cos_theta * cos_theta)) / cos_theta;
  // Beyond a = 6.5 both terms are below 1e-19, and a itself may be infinite.
  if (alpha_tan < 1 / 6.5) return 0;
  const double a = 1 / alpha_tan;
  constexpr double sqrt_pi = 1.7724538509055160273;
  return std::exp(-a * a) / (2 * a * sqrt_pi) - std::erfc(a) / 2;
}

double smith_masking_shadowing(double cos_o, double cos_i, double alpha) {
  return 1 / (1 + beckmann_lambda(cos_o, alpha) + beckmann_lambda(cos_i, alpha));
}

}  // namespace mica::host
