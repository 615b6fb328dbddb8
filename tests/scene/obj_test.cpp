#include <gtest/gtest.h>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
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
  EXPECT_EQ(load(kSquare +
                 "usemtl Mat#1\nf 1/1 2/2 3/3\nusemtl Brushed Steel \nf 1/1 3/3 4/4\nusemtl\nf 1/1 2/2 4/4\n")
                .parts,
            (std::vector<std::string>{"Mat#1", "Brushed Steel", ""}));
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

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).norm() / 2.0;
  return sum;
}

/// One polygon, as exporters write it, in six decimals.
std::string polygon(const std::vector<Vector3d>& corners) {
  std::string text, face = "f";
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const Vector3d& p = corners[n];
    text += fmt::format("v {:.6f} {:.6f} {:.6f}\nvt {:.6f} {:.6f}\n", p.x(), p.y(), p.z(), p.x(), p.y());
    face += fmt::format(" {}/{}", n + 1, n + 1);
  }
  return text + face + "\n";
}

TEST_F(Obj, PolygonsOfAnyKindAreCovered) {
  using Corners = std::vector<Vector3d>;
  const Corners edges = {{-.7, -.7, 0}, {-.2, -.7, 0}, {.1, -.7, 0}, {.3, -.7, 0}, {.7, -.7, 0},
                         {.7, -.1, 0},  {.7, .35, 0},  {.7, .7, 0},  {-.7, .7, 0}};
  for (int turn = 0; turn < 200; ++turn) {
    Corners turned;
    for (const Vector3d& corner : edges)
      turned.push_back(Eigen::AngleAxisd(0.0174874 * turn, Vector3d(0.1, 0.2, 1).normalized()) * corner);
    ASSERT_NEAR(area(load(polygon(turned))), 1.96, 1e-4) << turn;
  }
  EXPECT_NEAR(area(load(polygon({{-1, -1, 0}, {1, -1, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}}))), 3,
              1e-6);
  const Corners hole = {{-1, -1, 0},   {1, -1, 0},   {1, 1, 0},   {-1, 1, 0},   {-1, -1, 0},
                        {-.3, -.3, 0}, {-.3, .3, 0}, {.3, .3, 0}, {.3, -.3, 0}, {-.3, -.3, 0}};
  EXPECT_NEAR(area(load(polygon(hole))), 4 - 0.36, 1e-6);
  // A quad that is not flat has the area of its two triangles, whatever its shape.
  EXPECT_NEAR(area(load(polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}}))), std::sqrt(2), 1e-6);
  EXPECT_EQ(load(polygon({{0, 0, 0}, {1, 0, 0}, {0.2, 0.2, 0}, {0, 1, 0}})).triangles.size(), 2u);
  EXPECT_NEAR(area(load(polygon({{0, 0, 0}, {1, 0, 0}, {0.2, 0.2, 0}, {0, 1, 0}}))), 0.2, 1e-6);
}

TEST_F(Obj, ExportersAreUnderstood) {
  const std::string vertices =
      "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n";
  const std::string face = "f 1/1/1 2/2/1 3/3/1 4/4/1\n";
  std::string returns = vertices + face;
  std::replace(returns.begin(), returns.end(), '\n', '\r');
  const TriangleMesh plain = load(vertices + face);
  for (const std::string& text :
       {"\xef\xbb\xbf" + vertices + face, returns, vertices + "f 1/1/1 2/2/1 \\\r\n 3/3/1 4/4/1\n",
        vertices + "lod 1\nbevel off\nc_interp off\nd_interp off\nmg 0\nusemap off\nvp 0.5 0.5\n" + face,
        vertices + face + "f 1/1/1 2/2/1\n",  // a loose edge
        face + vertices,                      // indices may refer forward
        vertices + "f 1/1/ 2/2/ 3/3/ 4/4/\n", "v -1 -1 1e-400\n" + vertices.substr(10) + face}) {
    const TriangleMesh mesh = load(text);
    EXPECT_EQ(mesh.positions, plain.positions) << text;
    EXPECT_EQ(mesh.triangles, plain.triangles) << text;
    EXPECT_EQ(mesh.normals, plain.normals) << text;
  }
  EXPECT_EQ(load("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5\nf 1/1 2/1 3/1\n").uvs[0], Eigen::Vector2d(0.5, 0));
}

TEST_F(Obj, FarAwayMeshesKeepTheirShape) {
  // A bumpy sheet at UTM coordinates, moved back: the sheet at the origin, to rounding of the text.
  const auto sheet = [](double x0, double y0) {
    std::string text;
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 9; ++i)
        text += fmt::format("v {:.6f} {:.6f} {:.6f}\nvt {} {}\n", x0 + i * 0.25 - 1, y0 + j * 0.25 - 1,
                            0.3 * std::sin(i) * std::cos(j), i / 8.0, j / 8.0);
    for (int n = 1; n < 72; ++n)
      if (n % 9)
        text +=
            fmt::format("f {0}/{0} {1}/{1} {2}/{2}\nf {0}/{0} {2}/{2} {3}/{3}\n", n, n + 1, n + 10, n + 9);
    return text;
  };
  std::ofstream(path("near.obj")) << sheet(0, 0);
  std::ofstream(path("far.obj")) << sheet(500000, 4649776);
  const Geometry near({{MeshShape{path("near.obj")}, ""}});
  const Geometry far({{MeshShape{path("far.obj")}, "", {{1, 1, 1}, {0, 0, 0}, {-500000, -4649776, 0}}}});
  const Geometry there({{MeshShape{path("far.obj")}, ""}});
  for (double x = -0.95; x < 1; x += 0.37)
    for (double y = -0.9; y < 1; y += 0.23) {
      const Vector3d eye(0.3, -2, 5), direction = Vector3d(x, y, 0) - eye, moved(500000, 4649776, 0);
      const auto a = near.intersect({eye, direction}), b = far.intersect({eye, direction}),
                 c = there.intersect({eye + moved, direction});
      ASSERT_TRUE(a && b && c);
      EXPECT_LT((a->position - b->position).norm(), 1e-6);
      EXPECT_LT((a->normal - b->normal).norm(), 1e-5);
      EXPECT_LT((a->position + moved - c->position).norm(), 1e-6);
      EXPECT_LT((a->uv - c->uv).norm(), 1e-6);
    }
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
  EXPECT_EQ(error_of("vt\n"), "1: found 0 numbers after 'vt', expected 2");
  EXPECT_EQ(error_of(kSquare + "f 1/1\n"), "9: found a face of 1 corners, expected at least 3");
  EXPECT_EQ(error_of(kSquare + "f 1/1 2/2 5/3\n"), "9: found index 5 of a 'v', but there are 4");
  EXPECT_EQ(error_of(kSquare + "f 1/1 2/2 0/3\n"), "9: found index 0 of a 'v', but 4 precede it");
  EXPECT_EQ(error_of(kSquare + "f 1/1 2/2 3/-5\n"), "9: found index -5 of a 'vt', but 4 precede it");
  EXPECT_EQ(error_of(kSquare + "f 1/1/1 2/2/1 3/3/1\n"), "9: found index 1 of a 'vn', but there are 0");
  EXPECT_EQ(error_of(kSquare + "f 1 2 3\n"),
            "9: found '1' without a texture coordinate, expected v/vt or v/vt/vn");
  EXPECT_EQ(error_of(kSquare + "f 1//1 2//1 3//1\n"),
            "9: found '1//1' without a texture coordinate, expected v/vt or v/vt/vn");
  EXPECT_EQ(error_of(kSquare + "f 1/1/1/1 2/2 3/3\n"), "9: found '1/1/1/1', expected v/vt or v/vt/vn");
  EXPECT_EQ(error_of(kSquare + "f a/1 2/2 3/3\n"), "9: found 'a', expected the index of a 'v'");
  EXPECT_EQ(error_of(kSquare + "f 99999999999999999999/1 2/2 3/3\n"),
            "9: found '99999999999999999999', expected the index of a 'v'");
  EXPECT_EQ(error_of("v 0 0 0\ncurv 0 1 2\n"), "2: found the statement 'curv', expected v, vt, vn or f");
  // What another file says is not repeated, and control characters do not reach a terminal.
  EXPECT_EQ(error_of("root:x:0:0\n"),
            "1: found no statement of a Wavefront OBJ file, expected v, vt, vn or f");
  EXPECT_EQ(error_of("v 0 0 \x1b[31m\n"), "1: found '\\x1b[31m', expected a number");
  EXPECT_LT(error_of("v 0 0 " + std::string(100000, 'x')).size(), 200u);
  EXPECT_NE(error_of("\x1f\x8b\x08").find("gzip"), std::string::npos);
  EXPECT_NE(error_of("v " + std::string(17 << 20, '1')).find("found a line of more than"), std::string::npos);
  EXPECT_EQ(
      error_of("v 0 0 0\nv 4 0 0\nv 0 3 0\nv 4 3 0\nv 2 5 0\nvt 0 0\nf 1/1 2/1 3/1 4/1 5/1\n"),
      "7: found a polygon of 5 corners that crosses itself, expected one that does not: triangulate it when "
      "exporting");
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
