#include "host/scene/loft.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"

namespace mica::host {
namespace {

constexpr double kDifference = 1e-5;  // step in q and in the angle, for derivatives

using Section = std::function<LoftSection(double q)>;

/// A point of the section's outline: the upper side for angles between 0 and kPi, the edges at both.
Eigen::Vector3d outline(const LoftSection& section, double angle) {
  const double s = std::cos(angle);
  return {section.x, section.middle_y + section.half_width * s,
          section.rim_z - section.depth * (1 - s * s) + section.thickness / 2 * std::sin(angle)};
}

/// Outwards. Beside the tips, at which the section has no width, the nearest one that has stands in.
Eigen::Vector3d normal_of(const Section& section, double q, double angle) {
  const double inside = std::clamp(q, 20 * kDifference, 1 - 20 * kDifference);
  const Eigen::Vector3d along =
      outline(section(inside + kDifference), angle) - outline(section(inside - kDifference), angle);
  const LoftSection here = section(inside);
  const Eigen::Vector3d around = outline(here, angle + kDifference) - outline(here, angle - kDifference);
  return around.cross(along).stableNormalized();
}

}  // namespace

void add_loft(const Section& section, int steps, int steps_around, TriangleMesh* mesh) {
  const auto first = static_cast<std::uint32_t>(mesh->positions.size());
  for (int i = 0; i <= steps; ++i) {
    const double q = static_cast<double>(i) / steps;
    for (int j = 0; j < steps_around; ++j) {
      const double angle = 2 * kPi * j / steps_around;
      const Eigen::Vector3d position = outline(section(q), angle), normal = normal_of(section, q, angle);
      mesh->positions.push_back(position.cast<float>());
      mesh->normals.push_back(normal.cast<float>());
      mesh->tangents.push_back(
          (Eigen::Vector3d::UnitX() - normal.x() * normal).stableNormalized().cast<float>());
      mesh->uvs.emplace_back(position.x(), position.y());
    }
  }
  const auto around = static_cast<std::uint32_t>(steps_around);
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(steps); ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = first + i * around + j, b = first + i * around + (j + 1) % around;
      const std::uint32_t c = a + around, d = b + around;
      if (i > 0) mesh->triangles.push_back({a, b, d});
      if (i + 1 < static_cast<std::uint32_t>(steps)) mesh->triangles.push_back({a, d, c});
    }
  }
}

void place_body(const Eigen::Vector3d& center, double size, TriangleMesh* mesh) {
  for (Eigen::Vector3f& position : mesh->positions)
    position = (center + size * position.cast<double>()).cast<float>();
}

}  // namespace mica::host
