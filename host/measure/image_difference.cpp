#include "host/measure/image_difference.h"

#include <algorithm>
#include <cmath>
#include "host/base/constants.h"

namespace mica::host::bench {
namespace {

constexpr double kDegree = kPi / 180;

/// Angle of (a, b) in degrees, 0 to 360.
double hue(double a, double b) {
  if (a == 0 && b == 0) return 0;
  const double degrees = std::atan2(b, a) / kDegree;
  return degrees < 0 ? degrees + 360 : degrees;
}

double power_7(double x) {
  return x * x * x * x * x * x * x;
}

Eigen::Vector3d displayed(const Image& image, std::size_t pixel) {
  Eigen::Vector3d rgb;
  for (int c = 0; c < 3; ++c)
    rgb[c] = displayed_value(image.pixels[pixel * image.channels.size() + static_cast<std::size_t>(c)]);
  return rgb;
}

}  // namespace

double relative_mse(const Image& image, const Image& reference) {
  double sum = 0;
  for (std::size_t n = 0; n < reference.pixels.size(); ++n) {
    const double ref = reference.pixels[n], difference = image.pixels[n] - ref;
    sum += difference * difference / (ref * ref + 0.01);
  }
  return sum / static_cast<double>(reference.pixels.size());
}

Eigen::Vector3d lab_from_linear_rgb(const Eigen::Vector3d& rgb) {
  Eigen::Matrix3d to_xyz;  // IEC 61966-2-1
  to_xyz << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  const Eigen::Vector3d white = to_xyz * Eigen::Vector3d::Ones();
  const auto f = [](double t) {
    constexpr double delta = 6.0 / 29;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
  };
  const Eigen::Vector3d xyz = (to_xyz * rgb).cwiseQuotient(white);
  const double x = f(xyz.x()), y = f(xyz.y()), z = f(xyz.z());
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double ciede2000(const Eigen::Vector3d& lab_1, const Eigen::Vector3d& lab_2) {
  // Symbols and equation numbers are those of Sharma et al.
  const double l1 = lab_1[0], l2 = lab_2[0], b1 = lab_1[2], b2 = lab_2[2];
  const double c_bar = (std::hypot(lab_1[1], b1) + std::hypot(lab_2[1], b2)) / 2;           // (2), (3)
  const double g = 0.5 * (1 - std::sqrt(power_7(c_bar) / (power_7(c_bar) + power_7(25))));  // (4)
  const double a1 = (1 + g) * lab_1[1], a2 = (1 + g) * lab_2[1];                            // (5)
  const double c1 = std::hypot(a1, b1), c2 = std::hypot(a2, b2), h1 = hue(a1, b1),
               h2 = hue(a2, b2);  // (6), (7)

  double dh = 0;  // (10)
  if (c1 * c2 != 0) dh = std::remainder(h2 - h1, 360);
  const double delta_l = l2 - l1, delta_c = c2 - c1;                           // (8), (9)
  const double delta_h = 2 * std::sqrt(c1 * c2) * std::sin(dh / 2 * kDegree);  // (11)

  const double l_mean = (l1 + l2) / 2, c_mean = (c1 + c2) / 2;  // (12), (13)
  double h_mean = h1 + h2;                                      // (14)
  if (c1 * c2 != 0) {
    h_mean /= 2;
    if (std::abs(h1 - h2) > 180) h_mean += h1 + h2 < 360 ? 180 : -180;
  }
  const double t = 1 - 0.17 * std::cos((h_mean - 30) * kDegree) + 0.24 * std::cos(2 * h_mean * kDegree) +
                   0.32 * std::cos((3 * h_mean + 6) * kDegree) -
                   0.20 * std::cos((4 * h_mean - 63) * kDegree);                        // (15)
  const double delta_theta = 30 * std::exp(-std::pow((h_mean - 275) / 25, 2));          // (16)
  const double r_c = 2 * std::sqrt(power_7(c_mean) / (power_7(c_mean) + power_7(25)));  // (17)
  const double l50 = (l_mean - 50) * (l_mean - 50);
  const double s_l = 1 + 0.015 * l50 / std::sqrt(20 + l50);             // (18)
  const double s_c = 1 + 0.045 * c_mean, s_h = 1 + 0.015 * c_mean * t;  // (19), (20)
  const double r_t = -std::sin(2 * delta_theta * kDegree) * r_c;        // (21)
  const double l = delta_l / s_l, c = delta_c / s_c, h = delta_h / s_h;
  return std::sqrt(std::max(l * l + c * c + h * h + r_t * c * h, 0.0));  // (22)
}

DisplayDifference display_difference(const Image& image, const Image& reference) {
  DisplayDifference result;
  const std::size_t pixels = reference.pixels.size() / reference.channels.size();
  double sum = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const double difference = ciede2000(lab_from_linear_rgb(displayed(image, pixel)),
                                        lab_from_linear_rgb(displayed(reference, pixel)));
    result.pixels.push_back(static_cast<float>(difference));
    sum += difference;
  }
  result.mean = sum / static_cast<double>(pixels);
  std::vector<float> sorted = result.pixels;
  std::sort(sorted.begin(), sorted.end());
  result.percentile_95 = sorted[static_cast<std::size_t>(0.95 * static_cast<double>(pixels - 1))];
  return result;
}

}  // namespace mica::host::bench
