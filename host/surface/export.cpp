#include "host/surface/export.h"

#include <cmath>

namespace mica::host {

std::vector<float> to_signed_rgb(const Surface& surface) {
  std::vector<float> pixels;
  pixels.reserve(3 * surface.normals().size());
  for (int j = surface.height() - 1; j >= 0; --j) {
    for (int i = 0; i < surface.width(); ++i) {
      const Eigen::Vector2d& s = surface.texel(i, j);
      for (const double n : {s.x(), s.y(), std::sqrt(1 - s.squaredNorm())}) {
        pixels.push_back(static_cast<float>(n));
      }
    }
  }
  return pixels;
}

}  // namespace mica::host
