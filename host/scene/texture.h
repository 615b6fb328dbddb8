#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mica::host {

/// An image over a shape's uv: [0, 1)^2, repeated; row 0 at the top, where v is near 1. Bilinear between the
/// centres of pixels.
class Texture {
 public:
  /// 8- and 16-bit images are taken as sRGB and made linear, as `read_rgb` does. Throws FileError.
  explicit Texture(const std::string& path);

  /// R, G, B of linear light.
  Eigen::Vector3d at(const Eigen::Vector2d& uv) const;

 private:
  Eigen::Vector3d pixel(int column, int row) const;

  int width_, height_;
  std::vector<float> pixels_;
};

}  // namespace mica::host
