#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <string>

#include "host/scene/geometry.h"
#include "host/scene/obj.h"
#include "tests/image/folder.h"

namespace mica::host::obj_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

class Obj : public FolderTest {
 protected:
  TriangleMesh load(const std::string& text) {
    std::ofstream(path("a.obj"), std::ios::binary) << text;
    return load_obj(path("a.obj"));
  }
  std::string error_of(const std::string& text) {
    const std::string message = error([&] { load(text); });
    const std::string prefix = path("a.obj") + ":";
    return message.rfind(prefix, 0) == 0 ? message.substr(prefix.size()) : message;
  }
};

const std::string kSquare =
    "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

TEST_F(Obj, ReadsTrianglesWithEverything) {
  const TriangleMesh mesh = load(
      "# a comment\n\nmtllib x.mtl\no thing\ng part\ns off\nusemtl red\r\n"
      "v 0 0 0 # the first\nv 1 0 0 1.0\n\tv  +0 1e0  0.0 0.5 0.5 0.5\n"
      "vt 0 0\nvt 2 0 0\nvt 0 3\nvn 0 0 2\nvn 1 0 1\n"
      "l 1 2\nf 1/1/1 2/2/1 3/3/2\n");
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.positions, (std::vector<Vector3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.uvs[1], Eigen::Vector2d(2, 0));
  EXPECT_EQ(mesh.normals[0], Vector3f(0, 0, 1));
  EXPECT_TRUE(mesh.normals[2].isApprox(Vector3f(1, 0, 1) / std::sqrt(2.0f)));
  const UvGradients gradients = uv_gradients(mesh, 0);
  EXPECT_TRUE(gradients.dpdu.isApprox(Vector3d(0.5, 0, 0)));
  EXPECT_TRUE(gradients.dpdv.isApprox(Vector3d(0, 1 / 3.0, 0)));
  EXPECT_TRUE(mesh.tangents[0].normalized().isApprox(Vector3f(1, 0, 0)));
}

TEST_F(Obj, MaterialsAreParts) {
  const TriangleMesh mesh = load(kSquare +
                                 "f 1/1 2/2 3/3\nusemtl lid\nf 1/1 3/3 4/4\nusemtl body\nf 1/1 2/2 3/3 "
                                 "4/4\nusemtl lid\nf 2/2 3/3 4/4\n");
  EXPECT_EQ(mesh.parts, (std::vector<std::string>{"", "lid", "body"}));
  EXPECT_EQ(mesh.part_of_triangle, (std::vector<std::uint32_t>{0, 1, 2, 2, 1}));
  EXPECT_EQ(load(kSquare + "usemtl all\nf 1/1 2/2 3/3\n").parts, (std::vector<std::string>{"all"}));
  EXPECT_EQ(error_of("usemtl\n").rfind("1: found 0 names", 0), 0u);
}

TEST_F(Obj, NegativeIndicesCountBack) {
  const TriangleMesh forward = load(kSquare + "vn 0 0 1\nf 1/1/1 2/2/1 3/3/1\n");
  const TriangleMesh back = load(kSquare + "vn 0 0 1\nf -4/-4/-1 -3/-3/-1 -2/-2/-1\n");
  EXPECT_EQ(forward.positions, back.positions);
  EXPECT_EQ(forward.uvs, back.uvs);
}

TEST_F(Obj, PolygonsBecomeTrianglesThatCoverThem) {
  const TriangleMesh mesh = load(
      "v 1 0 0\nv 0.5 0.8 0\nv -0.5 0.8 0\nv -1 0 0\nv -0.5 -0.8 0\nv 0.5 -0.8 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
      "f 1/1 2/2 3/3 4/1 5/2 6/3\n");
  EXPECT_EQ(mesh.triangles.size(), 4u);
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    area += (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).z() / 2;
  EXPECT_NEAR(area, 2.4, 1e-6);
}

TEST_F(Obj, SquareAgreesWithThePlane) {
  load(kSquare + "f 1/1 2/2 3/3 4/4\n");
  const Geometry mesh({{MeshShape{path("a.obj")}, ""}}), plane({{PlaneShape{{0, 0, 0}, 2}, ""}});
  for (double x = -0.95; x < 1; x += 0.37)
    for (double y = -0.9; y < 1; y += 0.23) {
      const Ray ray{{0.3, -2, 5}, Vector3d(x, y, 0) - Vector3d(0.3, -2, 5)};
      const auto of_mesh = mesh.intersect(ray), of_plane = plane.intersect(ray);
      ASSERT_TRUE(of_mesh && of_plane);
      EXPECT_NEAR((of_mesh->uv - of_plane->uv).norm(), 0, 1e-14);
      EXPECT_NEAR((of_mesh->dpdu - of_plane->dpdu).norm(), 0, 1e-14);
      EXPECT_NEAR((of_mesh->dpdv - of_plane->dpdv).norm(), 0, 1e-14);
      EXPECT_EQ(of_mesh->normal, of_plane->normal);
    }
}

TEST_F(Obj, FacesWithoutNormalsAreFlat) {
  const TriangleMesh roof =
      load("v 0 0 1\nv 0 1 1\nv 1 0 0\nv -1 0 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 3/2 2/3\nf 1/1 2/2 4/3\n");
  ASSERT_EQ(roof.triangles.size(), 2u);
  for (const std::uint32_t corner : roof.triangles[0])
    EXPECT_TRUE(roof.normals[corner].isApprox(Vector3f(1, 0, 1).normalized()));
  for (const std::uint32_t corner : roof.triangles[1])
    EXPECT_TRUE(roof.normals[corner].isApprox(Vector3f(-1, 0, 1).normalized()));
}

TEST_F(Obj, MirroredHalvesKeepTheirTangents) {
  // Two triangles share an edge, its uv and its normals; u falls away from it on both sides.
  const TriangleMesh mesh = load(
      "v 0 0 0\nv 0 1 0\nv 1 0 0\nv -1 0 0\nvt 0 0\nvt 0 1\nvt 1 0\nvn 0 0 1\n"
      "f 1/1/1 3/3/1 2/2/1\nf 1/1/1 2/2/1 4/3/1\n");
  for (const std::uint32_t corner : mesh.triangles[0])
    EXPECT_TRUE(mesh.tangents[corner].normalized().isApprox(Vector3f(1, 0, 0)));
  for (const std::uint32_t corner : mesh.triangles[1])
    EXPECT_TRUE(mesh.tangents[corner].normalized().isApprox(Vector3f(-1, 0, 0)));
}

TEST_F(Obj, NeighboursShareTheirTangents) {
  const TriangleMesh mesh =
      load(kSquare + "vn 0 0 1\nv 2 0 1\nvt 2 0.5\nf 1/1/1 2/2/1 3/3/1 4/4/1\nf 2/2/1 5/5/1 3/3/1\n");
  EXPECT_EQ(mesh.positions.size(), 5u);
}

TEST_F(Obj, MistakesAreNamedWithTheirLine) {
  EXPECT_EQ(error_of("v 1 2\n"), "1: found 2 numbers after 'v', expected 3");
  EXPECT_EQ(error_of("v 1 2 3\nv 1 x2 3\n"), "2: found 'x2', expected a number");
  EXPECT_EQ(error_of("v 1 nan 3\n"), "1: found nan, expected a number between -1e15 and 1e15");
  EXPECT_EQ(error_of("v 1 1e99 3\n"), "1: found 1e99, expected a number between -1e15 and 1e15");
  EXPECT_EQ(error_of("v 1 1e999 3\n"), "1: found 1e999, expected a number between -1e15 and 1e15");
  EXPECT_EQ(error_of("vt 0.5\n"), "1: found 1 numbers after 'vt', expected 2");
  EXPECT_EQ(error_of(kSquare + "f 1/1 2/2\n"), "9: found a face of 2 corners, expected at least 3");
  EXPECT_EQ(error_of(kSquare + "f 1/1 2/2 5/3\n"), "9: found index 5 of a 'v', but 4 precede it");
  EXPECT_EQ(error_of(kSquare + "f 1/1 2/2 0/3\n"), "9: found index 0 of a 'v', but 4 precede it");
  EXPECT_EQ(error_of(kSquare + "f 1/1 2/2 3/-5\n"), "9: found index -5 of a 'vt', but 4 precede it");
  EXPECT_EQ(error_of(kSquare + "f 1/1/1 2/2/1 3/3/1\n"), "9: found index 1 of a 'vn', but 0 precede it");
  EXPECT_EQ(error_of(kSquare + "f 1 2 3\n"),
            "9: found '1' without a texture coordinate, expected v/vt or v/vt/vn");
  EXPECT_EQ(error_of(kSquare + "f 1//1 2//1 3//1\n"),
            "9: found '1//1' without a texture coordinate, expected v/vt or v/vt/vn");
  EXPECT_EQ(error_of(kSquare + "f 1/1/1/1 2/2 3/3\n"), "9: found '1/1/1/1', expected v/vt or v/vt/vn");
  EXPECT_EQ(error_of(kSquare + "f 1/1/ 2/2/ 3/3/\n"), "9: found '', expected the index of a 'vn'");
  EXPECT_EQ(error_of(kSquare + "f a/1 2/2 3/3\n"), "9: found 'a', expected the index of a 'v'");
  EXPECT_EQ(error_of(kSquare + "f 99999999999999999999/1 2/2 3/3\n"),
            "9: found '99999999999999999999', expected the index of a 'v'");
  EXPECT_EQ(error_of("curv 0 1 2\n"), "1: found the statement 'curv', expected v, vt, vn or f");
  EXPECT_EQ(error_of(kSquare + "v 0 -0.5 0\nf 1/1 5/1 2/2 3/3 4/4\n"),
            "10: found a polygon that is not convex, expected convex ones: triangulate it when exporting");
}

TEST_F(Obj, FilesWithoutFacesAreRefused) {
  const std::string file = path("a.obj");
  EXPECT_EQ(error([&] { load(""); }), file + ": holds no faces");
  EXPECT_EQ(error([&] { load(kSquare); }), file + ": holds no faces");
  EXPECT_EQ(error([&] { load(kSquare + "f 1/1 1/1 2/2\n"); }), file + ": holds no faces")
      << "only one without area";
  EXPECT_EQ(error([&] { load_obj(path("none.obj")); }),
            path("none.obj") + ": cannot read: No such file or directory");
  EXPECT_EQ(error([&] { load_obj(folder_.string()); }),
            folder_.string() + ": cannot read: not a regular file");
}

}  // namespace
}  // namespace mica::host::obj_test
