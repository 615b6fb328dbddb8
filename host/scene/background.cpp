#include "host/scene/background.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"

namespace mica::host {

Background::Background(const BackgroundDescription& description, Findings* findings)
    : color_(description.color) {
  if (!description.path.empty())
    *this = Background(read_radiance(description.path, description.choice, description.invalid, findings));
}

Background::Background(Image image)
    : color_(Color::Zero()), width_(image.width), height_(image.height), pixels_(std::move(image.pixels)) {}

Color Background::pixel(int column, int row) const {
  column = (column + width_) % width_;
  row = std::clamp(row, 0, height_ - 1);
  const float* rgb = &pixels_[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                                   static_cast<std::size_t>(column))];
  return {rgb[0], rgb[1], rgb[2]};
}

Color Background::radiance(const Eigen::Vector3d& direction) const {
  if (pixels_.empty()) return color_;
  const double longitude = std::atan2(direction.x(), direction.y());
  const double colatitude = std::atan2(std::hypot(direction.x(), direction.y()), direction.z());
  const double x = (0.5 + longitude / (2 * kPi)) * width_ - 0.5, y = colatitude / kPi * height_ - 0.5;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  const double right = x - column, below = y - row;
  return (1 - below) * ((1 - right) * pixel(column, row) + right * pixel(column + 1, row)) +
         below * ((1 - right) * pixel(column, row + 1) + right * pixel(column + 1, row + 1));
}

}  // namespace mica::host
