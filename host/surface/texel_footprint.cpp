#include "host/surface/texel_footprint.h"

#include <cmath>

namespace mica::host {

Footprint make_footprint(const Surface& surface, const Eigen::Vector2d& mean_uv, double sigma_major_texels,
                         double sigma_minor_texels, double angle) {
  const Eigen::Array2d texels(surface.width(), surface.height());
  const Eigen::Vector2d major =
      sigma_major_texels * Eigen::Array2d(std::cos(angle), std::sin(angle)) / texels;
  const Eigen::Vector2d minor =
      sigma_minor_texels * Eigen::Array2d(-std::sin(angle), std::cos(angle)) / texels;
  return {mean_uv, major * major.transpose() + minor * minor.transpose()};
}

}  // namespace mica::host
