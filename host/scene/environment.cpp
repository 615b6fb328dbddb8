#include "host/scene/environment.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/image/image.h"
#include "host/scene/background.h"
#include "host/scene/piecewise_constant.h"

namespace mica::host {
namespace {

/// Mean over a pixel's extent of what is linear between it and its neighbours: (1, 6, 1) / 8 an axis.
double mean_of_bilinear(const std::vector<double>& values, int width, int height, int column, int row) {
  const int columns[] = {(column + width - 1) % width, column, (column + 1) % width};
  const int rows[] = {std::max(row - 1, 0), row, std::min(row + 1, height - 1)};
  constexpr double share[] = {0.125, 0.75, 0.125};
  double sum = 0;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      sum += share[j] * share[i] *
             values[static_cast<std::size_t>(rows[j]) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(columns[i])];
  return sum;
}

/// Mean of the three channels of each pixel.
std::vector<double> brightness(const Image& image) {
  std::vector<double> values(image.pixels.size() / 3);
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel) {
    const float* rgb = &image.pixels[3 * pixel];
    values[pixel] = (double{rgb[0]} + rgb[1] + rgb[2]) / 3;
  }
  return values;
}

/// A furnace is an image of a single pixel.
Image image_of(const EnvironmentLight& light, Findings* findings) {
  if (light.path.empty()) return {1, 1, {"R", "G", "B"}, {1, 1, 1}, {}};
  return read_radiance(light.path, light.choice, light.invalid, findings);
}

}  // namespace

/// One light: its image, and pixels of which rows and columns are equal angles.
class Environment::Light {
 public:
  Light(const EnvironmentLight& description, Findings* findings)
      : Light(description, image_of(description, findings)) {}

  Light(const EnvironmentLight& description, Image image)
      : scale_(description.radiance),
        cos_rotation_(std::cos(description.rotation_degrees * kPi / 180)),
        sin_rotation_(std::sin(description.rotation_degrees * kPi / 180)),
        width_(image.width),
        height_(image.height) {
    const std::vector<double> values = brightness(image);
    image_ = Background(std::move(image));
    std::vector<double> rows;
    for (int row = 0; row < height_; ++row) {
      std::vector<double> columns;
      for (int column = 0; column < width_; ++column)
        columns.push_back(solid_angle(row) * mean_of_bilinear(values, width_, height_, column, row));
      columns_.emplace_back(columns);
      rows.push_back(columns_.back().sum());
    }
    rows_ = PiecewiseConstant(rows);
  }

  /// Its radiance over all directions, W/m^2, mean of the channels.
  double power() const { return rows_.sum() * scale_.mean(); }

  Color radiance(const Eigen::Vector3d& direction) const {
    return scale_.cwiseProduct(image_.radiance(to_image(direction)));
  }

  Eigen::Vector3d sample(Eigen::Vector2d uniform) const {
    const std::size_t row = rows_.sample(&uniform.y());
    const std::size_t column = columns_[row].sample(&uniform.x());
    const double top = cos_colatitude(static_cast<int>(row)),
                 bottom = cos_colatitude(static_cast<int>(row) + 1);
    const double z = top + uniform.y() * (bottom - top);
    const double longitude = 2 * kPi * ((static_cast<double>(column) + uniform.x()) / width_ - 0.5);
    const double radius = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
    const Eigen::Vector3d d(radius * std::sin(longitude), radius * std::cos(longitude), z);
    return {cos_rotation_ * d.x() - sin_rotation_ * d.y(), sin_rotation_ * d.x() + cos_rotation_ * d.y(), z};
  }

  double pdf(const Eigen::Vector3d& direction) const {
    const Eigen::Vector3d d = to_image(direction);
    const double longitude = std::atan2(d.x(), d.y());
    const double colatitude = std::atan2(std::hypot(d.x(), d.y()), d.z());
    const int column = std::clamp(static_cast<int>((0.5 + longitude / (2 * kPi)) * width_), 0, width_ - 1);
    const int row = std::clamp(static_cast<int>(colatitude / kPi * height_), 0, height_ - 1);
    return rows_.probability(static_cast<std::size_t>(row)) *
           columns_[static_cast<std::size_t>(row)].probability(static_cast<std::size_t>(column)) /
           solid_angle(row);
  }

 private:
  double cos_colatitude(int row) const { return std::cos(kPi * row / height_); }
  /// The solid angle of one pixel of that row.
  double solid_angle(int row) const {
    return 2 * kPi / width_ * (cos_colatitude(row) - cos_colatitude(row + 1));
  }
  Eigen::Vector3d to_image(const Eigen::Vector3d& d) const {
    return {cos_rotation_ * d.x() + sin_rotation_ * d.y(), cos_rotation_ * d.y() - sin_rotation_ * d.x(),
            d.z()};
  }

  Color scale_;
  double cos_rotation_, sin_rotation_;
  int width_, height_;
  Background image_{BackgroundDescription{}};
  PiecewiseConstant rows_;
  std::vector<PiecewiseConstant> columns_;  // one a row
};

Environment::Environment(const std::vector<EnvironmentLight>& lights, Findings* findings) {
  std::vector<double> powers;
  for (const EnvironmentLight& description : lights) {
    auto light = std::make_unique<Light>(description, findings);
    if (!(light->power() > 0)) continue;
    powers.push_back(light->power());
    lights_.push_back(std::move(light));
  }
  choice_ = PiecewiseConstant(powers);
}

Environment::~Environment() = default;
Environment::Environment(Environment&&) noexcept = default;

Color Environment::radiance(const Eigen::Vector3d& direction) const {
  Color sum = Color::Zero();
  for (const auto& light : lights_) sum += light->radiance(direction);
  return sum;
}

Eigen::Vector3d Environment::sample(const Eigen::Vector2d& uniform) const {
  Eigen::Vector2d rest = uniform;
  const std::size_t light = choice_.sample(&rest.x());
  return lights_[light]->sample(rest);
}

double Environment::pdf(const Eigen::Vector3d& direction) const {
  double sum = 0;
  for (std::size_t n = 0; n < lights_.size(); ++n) sum += choice_.probability(n) * lights_[n]->pdf(direction);
  return sum;
}

}  // namespace mica::host
