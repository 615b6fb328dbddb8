#include "host/scene/outline.h"

#include <cmath>

#include "host/base/constants.h"

namespace mica::host {
namespace {

constexpr int kOutlineStepsAround = 360, kStepsAnArc = 24, kStepsALine = 24;

Eigen::Vector2d to_the_right(const Eigen::Vector2d& direction) {
  return {direction.y(), -direction.x()};
}

/// The arc that rounds the corner between two directions: from where it leaves the first to where it joins
/// the second.
void add_arc(const OutlineCorner& corner, const Eigen::Vector2d& in, const Eigen::Vector2d& out,
             std::vector<OutlinePoint>* points) {
  const double turn =
      std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));  // to the left is positive
  const double side = turn < 0 ? 1 : -1;  // whether the centre is to the right or to the left
  const Eigen::Vector2d begin = corner.position - corner.radius * std::tan(std::abs(turn) / 2) * in;
  const Eigen::Vector2d center = begin + side * corner.radius * to_the_right(in);
  const Eigen::Vector2d normal = to_the_right(in);
  for (int n = 0; n <= kStepsAnArc; ++n) {
    const double angle = turn * n / kStepsAnArc, c = std::cos(angle), s = std::sin(angle);
    const Eigen::Vector2d turned(c * normal.x() - s * normal.y(), s * normal.x() + c * normal.y());
    points->push_back({center - side * corner.radius * turned, turned});
  }
}

}  // namespace

std::vector<OutlinePoint> rounded_outline(const std::vector<OutlineCorner>& corners) {
  const auto direction = [&](std::size_t from) {
    return (corners[from + 1].position - corners[from].position).normalized().eval();
  };
  std::vector<OutlinePoint> turns = {{corners[0].position, to_the_right(direction(0))}};
  for (std::size_t n = 1; n + 1 < corners.size(); ++n)
    add_arc(corners[n], direction(n - 1), direction(n), &turns);
  turns.push_back({corners.back().position, to_the_right(direction(corners.size() - 2))});

  std::vector<OutlinePoint> points;
  for (std::size_t n = 0; n + 1 < turns.size(); ++n) {
    const OutlinePoint &a = turns[n], &b = turns[n + 1];
    const int steps = a.normal.isApprox(b.normal, 1e-12) ? kStepsALine : 1;
    for (int step = 0; step < steps; ++step)
      points.push_back({a.position + (b.position - a.position) * step / steps, a.normal});
  }
  points.push_back(turns.back());
  return points;
}

void add_revolved(const std::vector<OutlinePoint>& outline, double circumference, const std::string& part,
                  TriangleMesh* mesh) {
  const auto part_index = static_cast<std::uint32_t>(mesh->parts.size());
  mesh->parts.push_back(part);
  auto ring = static_cast<std::uint32_t>(mesh->positions.size());
  double length = 0;
  for (std::size_t n = 0; n < outline.size(); ++n, ring += kOutlineStepsAround + 1) {
    if (n > 0) length += (outline[n].position - outline[n - 1].position).norm();
    for (int j = 0; j <= kOutlineStepsAround; ++j) {
      const double u = static_cast<double>(j) / kOutlineStepsAround, angle = 2 * kPi * u;
      const Eigen::Vector3d radial(-std::sin(angle), std::cos(angle), 0),
          forward(-std::cos(angle), -std::sin(angle), 0);
      const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
      mesh->positions.push_back(
          (outline[n].position.x() * radial + outline[n].position.y() * up).cast<float>());
      mesh->normals.push_back((outline[n].normal.x() * radial + outline[n].normal.y() * up).cast<float>());
      mesh->tangents.push_back(forward.cast<float>());
      mesh->uvs.emplace_back(u, length / circumference);
    }
    if (n + 1 == outline.size()) break;
    const bool from_axis = outline[n].position.x() < 1e-9, to_axis = outline[n + 1].position.x() < 1e-9;
    for (std::uint32_t j = 0; j < kOutlineStepsAround; ++j) {
      const std::uint32_t a = ring + j, b = a + kOutlineStepsAround + 1;
      if (!from_axis) mesh->triangles.push_back({a, a + 1, b + 1});
      if (!to_axis) mesh->triangles.push_back({a, b + 1, b});
    }
    mesh->part_of_triangle.resize(mesh->triangles.size(), part_index);
  }
}

}  // namespace mica::host
