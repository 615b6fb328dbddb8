#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mica::host {

/// Triangles with one position, unit normal, texture coordinate and tangent a vertex, interpolated linearly.
struct TriangleMesh {
  Eigen::Vector3d origin{0, 0, 0};  ///< that positions are relative to: far away floats are coarse
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector2d> uvs;
  std::vector<Eigen::Vector3f> tangents;  ///< towards +u; of any length, zero where uv has no direction
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::string> parts;               ///< names, in the order of their first triangles
  std::vector<std::uint32_t> part_of_triangle;  ///< empty when there is one part at most

  std::uint32_t part(std::uint32_t triangle) const {
    return part_of_triangle.empty() ? 0 : part_of_triangle[triangle];
  }
};

/// Position derivatives of one triangle, on which uv is linear; zero where uv is degenerate.
struct UvGradients {
  Eigen::Vector3d dpdu, dpdv;
};
UvGradients uv_gradients(const TriangleMesh& mesh, std::uint32_t triangle);

/// Sets each vertex's tangent to the mean over its triangles, weighted by their angle at the vertex, so that
/// the tangent frame and with it the half vector turn smoothly over the mesh.
void set_tangents(TriangleMesh* mesh);

}  // namespace mica::host
