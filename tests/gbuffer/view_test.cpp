// Camera and lamps, against what Blender 3.4.1 says of the same ones (world_to_camera_view of one point), and
// against its definitions of power.
#include <Eigen/Geometry>
#include <cmath>

#include "host/base/constants.h"
#include "host/gbuffer/view.h"
#include "tests/image/folder.h"

namespace mica::host::view_test {
namespace {

constexpr char kCamera[] =
    R"("matrix_world": [[0.9505637884140015, -0.01819125935435295, 0.309996098279953, 1.0],
    [0.2940438389778137, 0.373671293258667, -0.8797203898429871, -6.0],
    [-0.0998334214091301, 0.92738276720047, 0.36054742336273193, 3.0], [0, 0, 0, 1]],
    "angle_x": 0.691111207, "angle_y": 0.471089959, "ortho_scale": 5)";
constexpr char kNoTurn[] = R"("matrix_world": [[2, 0, 0, 1], [0, 3, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])";

class View : public FolderTest {
 protected:
  std::string write(const std::string& text) const {
    std::ofstream(path("view.json")) << text;
    return path("view.json");
  }
  BufferView with_lamp(const std::string& lamp, const std::string& blender = "5.0.1") const {
    return read_view(write(R"({"blender": ")" + blender +
                           R"(", "resolution": [160, 90], "camera": {"type": "PERSP", )" +
                           std::string(kCamera) + R"(}, "lamps": [{"name": "a", "color": [1, 0.5, 0], )" +
                           kNoTurn + ", " + lamp + "}]}"));
  }
  template <typename Light>
  Light light(const std::string& lamp) const {
    return std::get<Light>(with_lamp(lamp).lamps.front().light);
  }
};

struct Seen {
  const char* camera;
  int width, height;
  const char* aspect;
  double x, y;
};
class Cameras : public View, public testing::WithParamInterface<Seen> {};

TEST_P(Cameras, SeeAPointWhereBlenderDoes) {
  const Seen& seen = GetParam();
  const BufferView view = read_view(
      write(R"({"resolution": [)" + std::to_string(seen.width) + ", " + std::to_string(seen.height) +
            R"(], "pixel_aspect": )" + seen.aspect + R"(, "camera": {)" + seen.camera + ", " + kCamera +
            R"(}, "lamps": [{"name": "a", "type": "POINT", "energy": 1, )" + kNoTurn + "}]}"));
  const Eigen::Vector3d point(0.4, 0.2, 0.9);
  const auto pixel = view.camera.project(point);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), seen.x, 1e-4);
  EXPECT_NEAR(pixel->y(), seen.y, 1e-4);

  // A step of a pixel on a plane through the point is one of its ray differentials.
  const BufferCamera::Sight sight = view.camera.sight(point);
  EXPECT_LT((sight.ray.origin + sight.t * sight.ray.direction - point).norm(), 1e-12);
  const auto right = view.camera.project(point + sight.t * sight.ray.ddx);
  const auto down = view.camera.project(point + sight.t * sight.ray.ddy);
  EXPECT_LT((*right - *pixel - Eigen::Vector2d(1, 0)).norm(), 1e-7);  // axes in single precision
  EXPECT_LT((*down - *pixel - Eigen::Vector2d(0, 1)).norm(), 1e-7);
}

INSTANTIATE_TEST_SUITE_P(
    All, Cameras,
    testing::Values(
        Seen{R"("type": "PERSP", "sensor_fit": "AUTO")", 160, 90, "[1, 1]", 130.797739, 31.794214},
        Seen{R"("type": "PERSP", "sensor_fit": "AUTO", "shift": [0.1, -0.05])", 90, 160, "[1, 1]", 79.797735,
             58.794212},
        Seen{R"("type": "PERSP", "sensor_fit": "HORIZONTAL", "shift": [0.1, -0.05])", 90, 160, "[1, 1]",
             64.573726, 68.071747},
        Seen{R"("type": "PERSP", "sensor_fit": "VERTICAL", "shift": [0.1, -0.05])", 160, 90, "[1, 1]",
             113.860588, 29.357615},
        Seen{R"("type": "PERSP", "sensor_fit": "VERTICAL", "shift": [0.1, -0.05])", 160, 90, "[1, 2]",
             147.721186, 29.357615},
        Seen{R"("type": "PERSP", "shift": [0.1, -0.05])", 160, 90, "[2, 1]", 114.797735, 2.588428},
        Seen{R"("type": "PERSP", "shift": [0.1, -0.05])", 160, 90, "[1, 2]", 119.147453, 33.071744},
        Seen{R"("type": "ORTHO", "shift": [0.1, -0.05])", 160, 90, "[1, 2]", 114.645805, 33.656884},
        Seen{R"("type": "ORTHO", "shift": [0.1, -0.05])", 160, 90, "[1, 1]", 110.796280, 24.834466}));

TEST_F(View, PointAndSpotSpreadTheirPowerOverTheSphere) {
  const auto point = light<PointLight>(R"("type": "POINT", "energy": 8, "exposure": 1)");
  EXPECT_LT((point.intensity - Color(1, 0.5, 0) * 16 / (4 * kPi)).norm(), 1e-12);
  EXPECT_EQ(point.position, Eigen::Vector3d(1, 2, 3));
  const auto sphere = light<SphereLight>(R"("type": "POINT", "energy": 8, "radius": 0.1)");
  EXPECT_LT((sphere.intensity - Color(1, 0.5, 0) * 8 / (4 * kPi)).norm(), 1e-12);
  EXPECT_EQ(sphere.radius, 0.1);

  const BufferLamp spot =
      with_lamp(R"("type": "SPOT", "energy": 8, "spot_size": 1, "spot_blend": 0.5)").lamps.front();
  EXPECT_LT((std::get<PointLight>(spot.light).intensity - Color(1, 0.5, 0) * 8 / (4 * kPi)).norm(), 1e-12);
  ASSERT_TRUE(spot.cone);
  EXPECT_EQ(spot.cone->share({1, 2, 0}), 1);
  EXPECT_EQ(spot.cone->share({1, 2, 4}), 0);  // behind it
  EXPECT_EQ(spot.cone->share({1 + std::tan(0.501), 2, 2}), 0);
  const double half_way = std::acos(std::cos(0.5) + 0.25 * (1 - std::cos(0.5)));
  EXPECT_NEAR(spot.cone->share({1 + std::tan(half_way), 2, 2}), 0.5, 1e-9);  // smoothstep's middle
}

TEST_F(View, SunHasItsIrradianceAndAngle) {
  const auto sun = light<DirectionalLight>(R"("type": "SUN", "energy": 2, "angle": 0.02)");
  EXPECT_EQ(sun.irradiance, Color(2, 1, 0));
  EXPECT_EQ(sun.direction, Eigen::Vector3d(0, 0, -1));
  EXPECT_EQ(sun.angular_radius, 0.01);
}

TEST_F(View, AreaHasItsRadianceInADiskOfItsArea) {
  const auto disk =
      light<DiskLight>(R"("type": "AREA", "energy": 6, "shape": "RECTANGLE", "size": [0.5, 0.2])");
  const double area = 0.5 * 2 * 0.2 * 3;  // scaled
  EXPECT_NEAR(disk.radius * disk.radius * kPi, area, 1e-12);
  EXPECT_LT((disk.intensity - Color(1, 0.5, 0) * 6 / kPi).norm(),
            1e-12);  // radiance P / (pi area), times area
  const auto round = light<DiskLight>(R"("type": "AREA", "energy": 6, "shape": "DISK", "size": [0.5, 9])");
  EXPECT_NEAR(round.radius * round.radius, 0.25 * 2 * 0.25 * 3, 1e-12);
}

/// Cycles 3.4.1: kernel/light/common.h.
TEST_F(View, SpotsOfBlender3FallWithTheCosine) {
  const BufferLamp spot = with_lamp(R"("type": "SPOT", "energy": 8, "spot_size": 1)", "3.4.1").lamps.front();
  EXPECT_NEAR(spot.cone->share({1 + std::tan(0.4), 2, 2}), std::cos(0.4), 1e-12);
}

TEST_F(View, SaysWhatIsWrongAndWhere) {
  const auto problem = [&](const std::string& text) { return error([&] { read_view(write(text)); }); };
  EXPECT_NE(problem("{").find("is no JSON"), std::string::npos);
  EXPECT_NE(problem("[]").find("expected an object"), std::string::npos);
  EXPECT_NE(problem("{}").find("resolution: found nothing"), std::string::npos);
  EXPECT_NE(problem(R"({"resolution": [1, "a"]})").find("found \"a\""), std::string::npos);
  const std::string camera =
      R"({"resolution": [160, 90], "camera": {"type": "PERSP", )" + std::string(kCamera) + "}, ";
  EXPECT_NE(problem(camera + R"("lamps": []})").find("lamps: found none"), std::string::npos);
  EXPECT_NE(problem(camera + R"("lamps": [{"name": "a", "type": "POINT", )" + kNoTurn + "}]}")
                .find("lamps.0.energy"),
            std::string::npos);
  EXPECT_NE(problem(camera + R"("lamps": [{"name": "a", "type": "HEMI", "energy": 1, )" + kNoTurn + "}]}")
                .find("lamps.0.type: found \"HEMI\""),
            std::string::npos);
  EXPECT_NE(error([&] { read_view(path("none.json")); }).find("none.json: cannot be read"),
            std::string::npos);
}

}  // namespace
}  // namespace mica::host::view_test
