#include "host/methods/gaussians/mixture_bound.h"

#include <algorithm>
#include <cmath>

#include "kernels/types.h"

namespace mica::host {
namespace {

using namespace device_types;

/// Weight of the elements' own covariances beside the scatter of their means: it is they that culling reaches
/// several standard deviations of.
constexpr double kSpreadWeight = 4;

/// The longest axis of some elements, in units of MICA_BOUND_ONE: its length is 1 within 3e-5.
Eigen::Vector2d longest_axis(const std::vector<ElementMoments>& elements) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const ElementMoments& element : elements) sum += element.mean;
  const Eigen::Vector2d mean = sum / static_cast<double>(elements.size());
  double xx = 0, xy = 0, yy = 0;
  for (const ElementMoments& element : elements) {
    const Eigen::Vector2d d = element.mean - mean;
    xx += d.x() * d.x() + kSpreadWeight * element.xx;
    xy += d.x() * d.y() + kSpreadWeight * element.xy;
    yy += d.y() * d.y() + kSpreadWeight * element.yy;
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  return {std::round(MICA_BOUND_ONE * std::cos(angle)), std::round(MICA_BOUND_ONE * std::sin(angle))};
}

std::int16_t to_short(double value) {
  return static_cast<std::int16_t>(std::clamp<double>(value, INT16_MIN, INT16_MAX));
}

}  // namespace

void store_bound(const std::vector<ElementMoments>& elements, const BoundUnits& units, int child,
                 std::int16_t* node) {
  if (elements.empty()) {
    node[child + 32] = node[child + 64] = INT16_MAX;
    node[child + 48] = node[child + 80] = INT16_MIN;
    return;
  }
  const Eigen::Vector2d stored_axis = longest_axis(elements);
  const Eigen::Vector2d axis = stored_axis / MICA_BOUND_ONE, normal(-axis.y(), axis.x());
  Eigen::Array2d low = Eigen::Array2d::Constant(INFINITY), high = -low;
  Eigen::Array2d widest = Eigen::Array2d::Constant(units.spread * units.spread);  // what is rounded to anyway
  std::vector<Eigen::Array3d> covariances;                                        // along, both, across
  for (const ElementMoments& element : elements) {
    const Eigen::Array2d place(axis.dot(element.mean), normal.dot(element.mean));
    low = low.min(place), high = high.max(place);
    const Eigen::Vector2d by_axis(element.xx * axis.x() + element.xy * axis.y(),
                                  element.xy * axis.x() + element.yy * axis.y());
    const Eigen::Vector2d by_normal(element.xx * normal.x() + element.xy * normal.y(),
                                    element.xy * normal.x() + element.yy * normal.y());
    covariances.emplace_back(axis.dot(by_axis), std::abs(normal.dot(by_axis)), normal.dot(by_normal));
    widest = widest.max(Eigen::Array2d(axis.dot(by_axis), normal.dot(by_normal)));
  }
  // (a b; b c) <= diag(a + |b| r, c + |b| / r) for any r.
  const double r = std::sqrt(widest.x() / widest.y());
  Eigen::Array2d variance = Eigen::Array2d::Zero();
  for (const Eigen::Array3d& c : covariances)
    variance = variance.max(Eigen::Array2d(c[0] + c[1] * r, c[2] + c[1] / r));

  node[child] = to_short(stored_axis.x()), node[child + 16] = to_short(stored_axis.y());
  node[child + 32] = to_short(std::floor(low.x() / units.mean));
  node[child + 48] = to_short(std::ceil(high.x() / units.mean));
  node[child + 64] = to_short(std::floor(low.y() / units.mean));
  node[child + 80] = to_short(std::ceil(high.y() / units.mean));
  node[child + 96] = to_short(std::ceil(std::sqrt(variance.x()) / units.spread));
  node[child + 112] = to_short(std::ceil(std::sqrt(variance.y()) / units.spread));
}

}  // namespace mica::host
