#include "host/scene/mesh.h"

#include <Eigen/Geometry>
#include <cmath>

namespace mica::host {
namespace {

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

UvGradients uv_gradients(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Eigen::Vector3d p_b = (mesh.positions[b] - mesh.positions[a]).cast<double>();
  const Eigen::Vector3d p_c = (mesh.positions[c] - mesh.positions[a]).cast<double>();
  const Eigen::Vector2d uv_b = mesh.uvs[b] - mesh.uvs[a], uv_c = mesh.uvs[c] - mesh.uvs[a];
  const double determinant = uv_b.x() * uv_c.y() - uv_b.y() * uv_c.x();
  if (std::abs(determinant) <= 1e-12 * uv_b.norm() * uv_c.norm())
    return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  return {(uv_c.y() * p_b - uv_b.y() * p_c) / determinant, (uv_b.x() * p_c - uv_c.x() * p_b) / determinant};
}

void set_tangents(TriangleMesh* mesh) {
  std::vector<Eigen::Vector3d> sums(mesh->positions.size(), Eigen::Vector3d::Zero());
  for (std::uint32_t triangle = 0; triangle < mesh->triangles.size(); ++triangle) {
    const Eigen::Vector3d direction = uv_gradients(*mesh, triangle).dpdu.stableNormalized();
    const auto& corners = mesh->triangles[triangle];
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto position = [&](std::size_t i) {
        return mesh->positions[corners[i % 3]].cast<double>().eval();
      };
      const Eigen::Vector3d here = position(corner);
      sums[corners[corner]] +=
          angle_between(position(corner + 1) - here, position(corner + 2) - here) * direction;
    }
  }
  mesh->tangents.clear();
  for (const Eigen::Vector3d& sum : sums) mesh->tangents.push_back(sum.cast<float>());
}

}  // namespace mica::host
