#include "host/scene/sample_turns.h"

#include <algorithm>
#include <cmath>

#include "host/scene/pixel_fit.h"

namespace mica::host {

std::optional<Eigen::Matrix2d> half_vector_change(const std::vector<SeenPoint>& points, int n, int k,
                                                  std::size_t lamp, double sigma_pixels) {
  const SeenPoint& middle = points[static_cast<std::size_t>(k)];
  const auto is_alike = [&](const SeenPoint& point) {
    return point.hit && point.faces_eye && point.hit->shape == middle.hit->shape &&
           point.hit->part == middle.hit->part && alike(point.lamps, middle.lamps) &&
           point.lamps[lamp].is_above;
  };
  const int place[2] = {k % n, k / n}, stride[2] = {1, n};
  Eigen::Matrix2d change;
  for (int axis = 0; axis < 2; ++axis) {
    int ends[2] = {0, 0};  // steps to the neighbours
    for (const int step : {-1, 1}) {
      const int to = place[axis] + step, index = k + step * stride[axis];
      if (to >= 0 && to < n && is_alike(points[static_cast<std::size_t>(index)])) ends[step > 0] = step;
    }
    if (ends[0] == ends[1]) return std::nullopt;
    const auto half_vector = [&](int step) -> const Eigen::Vector2d& {
      const int index = k + step * stride[axis];
      return points[static_cast<std::size_t>(index)].lamps[lamp].half_vector;
    };
    const auto cosine = [&](int step) {
      const int index = k + step * stride[axis];
      const SeenPoint& point = points[static_cast<std::size_t>(index)];
      return point.frame.z.dot(point.to_eye);
    };
    const double foreshortened = std::abs(cosine(ends[1]) - cosine(ends[0])) * n / (ends[1] - ends[0]);
    if (!(sigma_pixels * foreshortened < kMostForeshortening * cosine(0))) return std::nullopt;
    change.col(axis) = (half_vector(ends[1]) - half_vector(ends[0])) * n / (ends[1] - ends[0]);
  }
  return change;
}

namespace {

/// Calls visit(point, axis) for those beside point k of a pixel of n x n.
template <typename Visit>
void visit_beside(const std::vector<SeenPoint>& points, int n, int k, const Visit& visit) {
  const int place[2] = {k % n, k / n}, stride[2] = {1, n};
  for (int axis = 0; axis < 2; ++axis)
    for (const int step : {-1, 1}) {
      const int to = place[axis] + step, index = k + step * stride[axis];
      if (to >= 0 && to < n) visit(points[static_cast<std::size_t>(index)], axis);
    }
}

}  // namespace

double missed_by_bend(const std::vector<SeenPoint>& points, int n, int k, double sigma_pixels) {
  const SeenPoint& middle = points[static_cast<std::size_t>(k)];
  const double cosine = middle.frame.z.dot(middle.to_eye);
  double most[2] = {0, 0};
  bool ends = false;
  visit_beside(points, n, k, [&](const SeenPoint& point, int axis) {
    if (!point.hit || !point.faces_eye || point.hit->shape != middle.hit->shape ||
        point.hit->part != middle.hit->part)
      ends = true;
    else
      most[axis] = std::max(most[axis], std::abs(point.frame.z.dot(point.to_eye) - cosine) * n);
  });
  return ends ? 1 : std::min(0.5 * sigma_pixels * std::hypot(most[0], most[1]) / cosine, 1.0);
}

std::vector<bool> lights_beside(const std::vector<SeenPoint>& points, int n, int k, std::size_t lights) {
  std::vector<bool> seen(lights, false);
  visit_beside(points, n, k, [&](const SeenPoint& point, int) {
    for (const SeenLamp& lamp : point.lamps)
      if (lamp.visible > 0) seen[lamp.light] = true;
  });
  return seen;
}

}  // namespace mica::host
