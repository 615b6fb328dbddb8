// Draws the studio that ships as data/environments/studio.exr: softboxes around a set with a bright floor,
// and a few bare bulbs, small enough to light single glints.
//   studio_environment FILE.exr

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "host/base/constants.h"

namespace {

using mica::host::kPi;

constexpr int kWidth = 512, kHeight = 256;
constexpr int kSamples = 4;  // a pixel and axis

using Color = Eigen::Vector3d;

/// 0 below, 1 above, smooth over `softness` about 0.
double step(double x, double softness) {
  const double t = std::clamp(0.5 + x / softness, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// A rectangle that faces the set, brightest in its middle.
struct Softbox {
  Eigen::Vector3d towards;         ///< has any length
  double half_width, half_height;  ///< at distance 1
  Color radiance;

  Color operator()(const Eigen::Vector3d& direction) const {
    const Eigen::Vector3d z = towards.normalized(), x = Eigen::Vector3d::UnitZ().cross(z).normalized();
    const double depth = direction.dot(z);
    if (depth <= 0.05) return Color::Zero();
    const double right = direction.dot(x) / depth / half_width;
    const double up = direction.dot(z.cross(x)) / depth / half_height;
    const double inside = step(1 - std::abs(right), 0.06) * step(1 - std::abs(up), 0.06);
    return inside * (1 - 0.35 * std::min(1.0, (right * right + up * up) / 2)) * radiance;
  }
};

/// A bare lamp.
struct Bulb {
  Eigen::Vector3d towards;  ///< has any length
  double radius;            ///< radians
  Color radiance;

  Color operator()(const Eigen::Vector3d& direction) const {
    const double angle = std::acos(std::clamp(direction.dot(towards.normalized()), -1.0, 1.0));
    return step(1 - angle / radius, 0.3) * radiance;
  }
};

/// Walls that darken upwards, a floor that darkens towards the set.
Color room(const Eigen::Vector3d& direction) {
  const double z = direction.z();
  const Color wall = Color(0.16, 0.17, 0.19) * std::exp(-2.2 * std::max(z, 0.0)) + Color(0.015, 0.016, 0.02);
  const Color floor = Color(0.34, 0.32, 0.30) * (1 - 0.6 * std::sqrt(std::clamp(-z, 0.0, 1.0)));
  return wall + step(-z, 0.04) * (floor - wall);
}

Color radiance(const Eigen::Vector3d& direction) {
  static const Softbox boxes[] = {
      {{-0.75, -0.8, 0.75}, 0.42, 0.55, {13.0, 12.6, 12.0}},  // key, behind the camera on the left
      {{1.0, -0.25, 0.3}, 0.16, 0.75, {5.2, 5.7, 6.6}},       // strip, on the right
      {{0.35, 1.0, 0.55}, 0.75, 0.13, {8.5, 7.4, 6.0}},       // rim, behind the set
      {{0.05, -0.1, 1.0}, 0.30, 0.30, {3.0, 3.0, 3.0}},       // overhead
  };
  static const Bulb bulbs[] = {
      {{0.55, -0.8, 0.55}, 0.022, {420, 390, 340}},
      {{-0.15, -0.95, 0.75}, 0.018, {420, 410, 400}},
      {{-0.9, 0.25, 0.5}, 0.022, {260, 300, 380}},
      {{0.8, 0.55, 0.35}, 0.018, {420, 360, 280}},
  };
  Color sum = room(direction);
  for (const Softbox& box : boxes) sum += box(direction);
  for (const Bulb& bulb : bulbs) sum += bulb(direction);
  return sum;
}

/// Mean over a pixel; the middle of the image lies along +y, its right along +x.
Color pixel(int column, int row) {
  Color sum = Color::Zero();
  for (int n = 0; n < kSamples * kSamples; ++n) {
    const int right = n % kSamples, down = n / kSamples;
    const double x = column + (right + 0.5) / kSamples, y = row + (down + 0.5) / kSamples;
    const double longitude = 2 * kPi * (x / kWidth - 0.5), colatitude = kPi * y / kHeight;
    sum += radiance({std::sin(longitude) * std::sin(colatitude), std::cos(longitude) * std::sin(colatitude),
                     std::cos(colatitude)});
  }
  return sum / (kSamples * kSamples);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: studio_environment FILE.exr\n");
    return 2;
  }
  std::vector<float> pixels;
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const Color color = pixel(column, row);
      for (int channel = 0; channel < 3; ++channel) pixels.push_back(static_cast<float>(color[channel]));
    }
  }
  OIIO::ImageSpec spec(kWidth, kHeight, 3, OIIO::TypeDesc::HALF);
  spec.attribute("compression", "zip");
  const std::unique_ptr<OIIO::ImageOutput> file = OIIO::ImageOutput::create(argv[1]);
  if (!file || !file->open(argv[1], spec) || !file->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) ||
      !file->close()) {
    fmt::print(stderr, "{}: cannot be written: {}\n", argv[1], file ? file->geterror() : OIIO::geterror());
    return 4;
  }
  return 0;
}
