#include "host/methods/cavities/compensation.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/microfacet/circle_share.h"

namespace mica::host {

double specular_lobe_sigma(double roughness, double width) {
  return std::min(width * roughness, std::max(1.0, kMirrorWidth * roughness));
}

double compensation(Compensation kind, const Eigen::Vector3d& view, const Eigen::Vector3d& light,
                    double roughness, double width) {
  if (!(view.z() > 0 && light.z() > 0)) return 0;
  if (kind == Compensation::diffuse) return light.z() / kPi;
  const double sigma = specular_lobe_sigma(roughness, width);
  const double squared = (light + view).head<2>().squaredNorm() / (sigma * sigma);
  if (squared > 80) return 0;  // below 1e-17 of the peak
  // i_z di is the area of (i_x, i_y).
  return light.z() * std::exp(-0.5 * squared) /
         (2 * kPi * sigma * sigma * share_in_unit_circle({view.head<2>().norm(), 0}, {sigma, sigma}));
}

}  // namespace mica::host
