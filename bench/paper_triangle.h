#pragma once

#include <algorithm>
#include <cmath>

namespace mica::host::bench {

/// Coefficients of Q(u, v) = a u^2 + 2b uv + c v^2 + 2d u + 2e v + f.
struct Quadratic {
  double a, b, c, d, e, f;
};

namespace paper {

inline constexpr double kSqrtPi = 1.77245385090551602730;

/// erf on [-inf, -3], [-3, -2], ..., [2, 3], [3, inf] as c0 + c1 x + c2 x^2: the continuous least squares
/// fit.
inline constexpr double erf_pieces[8][3] = {{-1, 0, 0},
                                            {-0.8928203806, 0.0785660179, 0.0142798260},
                                            {-0.3579861124, 0.6683926095, 0.1754845548},
                                            {0, 1.2210338591, 0.3701396920},
                                            {0, 1.2210338591, -0.3701396920},
                                            {0.3579861124, 0.6683926095, -0.1754845548},
                                            {0.8928203806, 0.0785660179, -0.0142798260},
                                            {1, 0, 0}};

/// The Gaussian exp(-a (u - b)^2), and what its integrals need at one place.
struct OuterGaussian {
  double a, b, root_a;

  struct Place {
    double y, error_function, exponential;
  };
  /// erfc(z) given exp(-z^2), to 1.5e-7 [Abramowitz and Stegun 7.1.26].
  static double complement(double z, double exponential) {
    const double t = 1 / (1 + 0.3275911 * z);
    return t * exponential *
           (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
  }
  Place at(double u) const {
    const double y = u - b, exponential = std::exp(-a * y * y);
    return {y, std::copysign(1 - complement(root_a * std::abs(y), exponential), y), exponential};
  }
  /// [Yan14] Eq. 12, expquad, between two places for k0 + k1 y + k2 y^2.
  double expquad(const Place& from, const Place& to, double k0, double k1, double k2) const {
    const double half_inverse = 0.5 / a;
    const double m0 = 0.5 * kSqrtPi / root_a * (to.error_function - from.error_function);
    const double m1 = half_inverse * (from.exponential - to.exponential);
    const double m2 = half_inverse * (m0 + from.y * from.exponential - to.y * to.exponential);
    return k0 * m0 + k1 * m1 + k2 * m2;
  }
};

/// [Yan14] Eq. 11, experf, kept in u instead of x = p + q u, so that q may be 0.
inline double experf(const OuterGaussian& gaussian, double p, double q, const OuterGaussian::Place& first,
                     const OuterGaussian::Place& last) {
  const double sign = q < 0 ? -1 : 1;  // erf is odd: let x grow with u
  p *= sign;
  q *= sign;
  int piece = static_cast<int>(std::clamp(std::floor(p) + 4, 0.0, 7.0));
  double sum = 0;
  OuterGaussian::Place from = first;
  for (bool done = false; !done; ++piece) {
    done = piece == 7 || p + q <= piece - 3;
    const OuterGaussian::Place to = done ? last : gaussian.at((piece - 3 - p) / q);
    const double* c = erf_pieces[piece];
    const double x = p + q * gaussian.b;
    sum += gaussian.expquad(from, to, c[0] + x * (c[1] + x * c[2]), q * (c[1] + 2 * x * c[2]), q * q * c[2]);
    from = to;
  }
  return sign * sum;
}

}  // namespace paper

/// Integral of exp(-Q/2) over the triangle 0 < u, 0 < v, u + v < 1, by [Yan14] Eq. 9-12; c > 0 and a c > b^2.
/// In double: single precision gains less than a tenth here and loses all digits where the Gaussian is far
/// wider than the triangle.
inline double integrate_paper_triangle(const Quadratic& q) {
  // Inner integral over v from 0 to 1 - u: complete the square, v + (b u + e) / c.
  const double inverse_c = 1 / q.c;
  const double a = q.a - q.b * q.b * inverse_c, d = q.d - q.b * q.e * inverse_c,
               f = q.f - q.e * q.e * inverse_c;
  const double root = std::sqrt(0.5 * q.c);
  const double low = root * q.e * inverse_c, low_slope = root * q.b * inverse_c;
  const double high = root + low, high_slope = low_slope - root;
  constexpr double flat = 3;  // both arguments beyond: erf is constant in between
  if ((low >= flat && low + low_slope >= flat) || (high <= -flat && high + high_slope <= -flat)) return 0;

  // Outer Gaussian exp(-(a u^2 + 2 d u + f) / 2) = exp(-peak / 2) exp(-a/2 (u + d/a)^2).
  const double peak = f - d * d / a;
  const paper::OuterGaussian gaussian{0.5 * a, -d / a, std::sqrt(0.5 * a)};
  constexpr double beyond = 50;  // 5 standard deviations of both Gaussians
  const double nearest = std::clamp(gaussian.b, 0.0, 1.0) - gaussian.b;
  if (peak + a * nearest * nearest > beyond) return 0;
  const paper::OuterGaussian::Place first = gaussian.at(0), last = gaussian.at(1);
  const double difference = paper::experf(gaussian, high, high_slope, first, last) -
                            paper::experf(gaussian, low, low_slope, first, last);
  return 0.5 * paper::kSqrtPi / root * std::exp(-0.5 * peak) * difference;
}

}  // namespace mica::host::bench
