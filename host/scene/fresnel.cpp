#include "host/scene/fresnel.h"

#include <algorithm>
#include <cmath>

namespace mica::host {
namespace {

/// Schlick, "An Inexpensive BRDF Model for Physically-Based Rendering" (1994), Eq. 15.
Color schlick_reflectance(double cos_i, const Color& normal_incidence) {
  const double x = 1 - cos_i, x2 = x * x;
  return normal_incidence + (Color::Ones() - normal_incidence) * (x2 * x2 * x);
}

struct Reflectance {
  double cos_i;
  Color operator()(const ConductorFresnel& f) const {
    return {conductor_reflectance(cos_i, f.eta[0], f.k[0]), conductor_reflectance(cos_i, f.eta[1], f.k[1]),
            conductor_reflectance(cos_i, f.eta[2], f.k[2])};
  }
  Color operator()(const DielectricFresnel& f) const {
    return Color::Constant(dielectric_reflectance(cos_i, f.ior));
  }
  Color operator()(const ColorFresnel& f) const { return schlick_reflectance(cos_i, f.color); }
};

struct Below {
  double ior;
  Fresnel operator()(const ConductorFresnel& f) const { return ConductorFresnel{f.eta / ior, f.k / ior}; }
  Fresnel operator()(const DielectricFresnel& f) const { return DielectricFresnel{f.ior / ior}; }
  Fresnel operator()(const ColorFresnel& f) const { return f; }
};

}  // namespace

double dielectric_reflectance(double cos_i, double ior) {
  const double cos2_t = 1 - (1 - cos_i * cos_i) / (ior * ior);  // Snell
  if (cos2_t <= 0) return 1;                                    // total reflection
  const double cos_t = std::sqrt(cos2_t);
  const double r_s = (cos_i - ior * cos_t) / (cos_i + ior * cos_t);
  const double r_p = (ior * cos_i - cos_t) / (ior * cos_i + cos_t);
  return (r_s * r_s + r_p * r_p) / 2;
}

// With (eta + i k) cos_t = a + i b, both polarisations are rational in a, a^2 + b^2 and cos_i:
// Born & Wolf, Principles of Optics, sec. 14.2.
double conductor_reflectance(double cos_i, double eta, double k) {
  const double cos2 = cos_i * cos_i, sin2 = 1 - cos2;
  const double real = eta * eta - k * k - sin2;  // a^2 - b^2
  const double a2_b2 = std::sqrt(real * real + 4 * eta * eta * k * k);
  const double a_cos = std::sqrt(std::max(0.0, (a2_b2 + real) / 2)) * cos_i;
  const double sum_s = a2_b2 + cos2, sum_p = cos2 * a2_b2 + sin2 * sin2;
  if (sum_s + 2 * a_cos <= 0) return 1;  // grazing incidence on an index of 1 or less
  const double r_s = (sum_s - 2 * a_cos) / (sum_s + 2 * a_cos);
  if (sum_p + 2 * a_cos * sin2 <= 0) return r_s;  // normal incidence on an index of 0
  return r_s * (1 + (sum_p - 2 * a_cos * sin2) / (sum_p + 2 * a_cos * sin2)) / 2;
}

Color reflectance(const Fresnel& fresnel, double cos_i) {
  return std::visit(Reflectance{std::clamp(cos_i, 0.0, 1.0)}, fresnel);
}

Fresnel below(const Fresnel& fresnel, double ior) {
  return std::visit(Below{ior}, fresnel);
}

}  // namespace mica::host
