#include "host/scene/texture.h"

#include <cmath>
#include <cstddef>

#include "host/image/image.h"

namespace mica::host {

Texture::Texture(const std::string& path) {
  Image image = read_rgb(path);
  width_ = image.width, height_ = image.height;
  pixels_ = std::move(image.pixels);
}

Eigen::Vector3d Texture::pixel(int column, int row) const {
  column = (column + width_) % width_, row = (row + height_) % height_;
  const float* rgb = &pixels_[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                                   static_cast<std::size_t>(column))];
  return {rgb[0], rgb[1], rgb[2]};
}

Eigen::Vector3d Texture::at(const Eigen::Vector2d& uv) const {
  const Eigen::Vector2d tile = uv - uv.array().floor().matrix();
  const double x = tile.x() * width_ - 0.5, y = (1 - tile.y()) * height_ - 0.5;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  const double right = x - column, below = y - row;
  return (1 - below) * ((1 - right) * pixel(column, row) + right * pixel(column + 1, row)) +
         below * ((1 - right) * pixel(column, row + 1) + right * pixel(column + 1, row + 1));
}

}  // namespace mica::host
