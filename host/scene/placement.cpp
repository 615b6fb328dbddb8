#include "host/scene/placement.h"

#include "host/base/constants.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr double kDegree = kPi / 180;

Eigen::Affine3d transform_of(const Placement& placement) {
  const Eigen::Vector3d angles = kDegree * placement.rotate_degrees;
  return Eigen::Translation3d(placement.translate) * Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()) * Eigen::Scaling(placement.scale);
}

}  // namespace

PlacedFrame::PlacedFrame(const Placement& placement, const Eigen::Vector3d& origin)
    : is_identity_(placement.scale == Eigen::Vector3d::Ones() && placement.rotate_degrees.isZero(0) &&
                   placement.translate.isZero(0) && origin.isZero(0)),
      to_scene_(transform_of(placement) * Eigen::Translation3d(origin)),
      to_shape_(to_scene_.inverse()),
      normal_to_scene_(to_shape_.linear().transpose()) {
  if (!(placement.scale.minCoeff() > 0 && to_scene_.matrix().allFinite() && to_shape_.matrix().allFinite()))
    throw UsageError("placement of a shape: expected finite values and scales above 0");
}

Ray PlacedFrame::to_shape(const Ray& ray) const {
  return {to_shape_ * ray.origin, to_shape_.linear() * ray.direction};
}

Hit PlacedFrame::to_scene(Hit hit, const Eigen::Vector3d& middle) const {
  const Eigen::Matrix3d& linear = to_scene_.linear();
  // Rays go to the shape's coordinates in single precision, term by term.
  const Eigen::Vector3d terms =
      linear.cwiseAbs() * hit.position.cwiseAbs() + (to_scene_.translation() - middle).cwiseAbs();
  hit.position = to_scene_ * hit.position;
  hit.face_normal = (normal_to_scene_ * hit.face_normal).normalized();
  // No scale stretches more than all of the matrix.
  hit.error = hit.error * linear.norm() + kRelativeError * hit.face_normal.cwiseAbs().dot(terms);
  hit.normal = (normal_to_scene_ * hit.normal).normalized();
  hit.tangent = linear * hit.tangent;
  hit.dpdu = linear * hit.dpdu;
  hit.dpdv = linear * hit.dpdv;
  return hit;
}

}  // namespace mica::host
