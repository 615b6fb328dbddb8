#include "host/scene/bounce_fresnel.h"

#include "host/scene/fresnel.h"

namespace mica::host {

BounceFresnel::BounceFresnel(const LayeredMaterial& layers, const Eigen::Vector3d& view,
                             const Eigen::Vector3d& light)
    : single(reflectance(layers.material.specular, light.dot((view + light).normalized()))),
      multiple(reflectance(layers.material.specular, view.z())) {
  if (!layers.material.diffuse.isZero(0)) multiple = multiple.cwiseMin(layers.energy.mirrored(view.z()));
}

}  // namespace mica::host
