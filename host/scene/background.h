#pragma once

#include <vector>

#include "host/image/image.h"
#include "host/scene/description.h"

namespace mica::host {

/// Radiance from far away.
///
/// The image spans all directions: its middle lies along +y, its right along +x, its top row around +z.
class Background {
 public:
  /// Throws FileError for an image that cannot be used. @param findings what was repaired in it.
  explicit Background(const BackgroundDescription& description, Findings* findings = nullptr);
  explicit Background(Image image);  ///< of R, G, B

  /// @param direction of any length but 0. Bilinear between the centres of pixels.
  Color radiance(const Eigen::Vector3d& direction) const;

 private:
  Color pixel(int column, int row) const;

  Color color_;
  int width_ = 0, height_ = 0;  ///< 0 without an image
  std::vector<float> pixels_;   ///< R, G, B
};

}  // namespace mica::host
