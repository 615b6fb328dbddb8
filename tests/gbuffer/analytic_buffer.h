#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

#include "host/base/constants.h"
#include "host/image/image.h"

/// G-buffers of shapes that have formulas, as a renderer would write them that sees through pixel centres.
namespace mica::host::analytic_buffer {

struct Surface {
  Eigen::Vector3d position, normal, tangent;
  Eigen::Vector2d uv;
};
/// Where a ray meets the shape.
using Shape =
    std::function<std::optional<Surface>(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction)>;

/// Mica's own sphere of unit radius about the origin.
inline std::optional<Surface> sphere(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const double b = origin.dot(direction) / direction.squaredNorm();
  const double root = b * b - (origin.squaredNorm() - 1) / direction.squaredNorm();
  if (!(root > 0)) return std::nullopt;
  const Eigen::Vector3d n = (origin + (-b - std::sqrt(root)) * direction).normalized();
  const double u = std::atan2(n.y(), n.x()) / (2 * kPi);
  return Surface{n, n, {-n.y(), n.x(), 0}, {u < 0 ? u + 1 : u, 0.5 + std::asin(n.z()) / kPi}};
}

/// A square of side 4 in the plane z = 0, uv over its sides.
inline std::optional<Surface> plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d p = origin - origin.z() / direction.z() * direction;
  if (p.head<2>().cwiseAbs().maxCoeff() > 2) return std::nullopt;
  return Surface{p, {0, 0, 1}, {1, 0, 0}, p.head<2>() / 4 + Eigen::Vector2d(0.5, 0.5)};
}

/// A camera at `position` that looks at the origin, up towards z.
struct Camera {
  Eigen::Vector3d position;
  double fov_degrees = 24;  ///< vertical
  int width = 48, height = 36;

  Eigen::Vector3d forward() const { return -position.normalized(); }
  Eigen::Vector3d right() const { return forward().cross(Eigen::Vector3d::UnitZ()).normalized(); }
  Eigen::Vector3d up() const { return right().cross(forward()); }
  double pixel() const { return 2 * std::tan(fov_degrees * kPi / 360) / height; }
  Eigen::Vector3d direction(int row, int column) const {
    return forward() + pixel() * ((column + 0.5 - width / 2.0) * right() - (row + 0.5 - height / 2.0) * up());
  }
};

inline const std::vector<std::string>& channels() {
  static const std::vector<std::string> all = {"ViewLayer.Position.X",
                                               "ViewLayer.Position.Y",
                                               "ViewLayer.Position.Z",
                                               "ViewLayer.smooth_normal.R",
                                               "ViewLayer.smooth_normal.G",
                                               "ViewLayer.smooth_normal.B",
                                               "ViewLayer.true_normal.R",
                                               "ViewLayer.true_normal.G",
                                               "ViewLayer.true_normal.B",
                                               "ViewLayer.tangent.R",
                                               "ViewLayer.tangent.G",
                                               "ViewLayer.tangent.B",
                                               "ViewLayer.UV.U",
                                               "ViewLayer.UV.V",
                                               "ViewLayer.glint_id.X",
                                               "Lamps.Combined_bulb.R",
                                               "Lamps.Combined_bulb.G",
                                               "Lamps.Combined_bulb.B"};
  return all;
}
constexpr std::size_t kUv = 12, kId = 14, kLamp = 15;  // first channels of them
constexpr double kBulbIntensity = 25;                  // W/sr
inline Eigen::Vector3d bulb() {
  return {3, -3, 4};
}

/// Of id 1, without shadows.
inline Image buffer(const Camera& camera, const Shape& shape) {
  Image image{camera.width, camera.height, channels(), {}, {{"Software", "a renderer"}}};
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) {
      const auto seen = shape(camera.position, camera.direction(row, column));
      std::vector<double> values(channels().size(), 0);
      if (seen) {
        const Eigen::Vector3d to_bulb = bulb() - seen->position;
        const double light = kBulbIntensity * std::max(to_bulb.normalized().dot(seen->normal), 0.0) /
                             to_bulb.squaredNorm() / kPi;
        values.clear();
        for (const Eigen::Vector3d& v : {seen->position, seen->normal, seen->normal, seen->tangent})
          values.insert(values.end(), {v.x(), v.y(), v.z()});
        values.insert(values.end(), {seen->uv.x(), seen->uv.y(), 1, light, light, light});
      }
      for (const double value : values) image.pixels.push_back(static_cast<float>(value));
    }
  return image;
}

inline std::string text_of(const Eigen::Vector3d& v) {
  return "[" + std::to_string(v.x()) + ", " + std::to_string(v.y()) + ", " + std::to_string(v.z()) + "]";
}

/// The camera as JSON, with one point lamp.
inline std::string view(const Camera& camera) {
  const auto row = [&](int n) {
    char text[200];
    std::snprintf(text, sizeof text, "[%.15g, %.15g, %.15g, %.15g]", camera.right()[n], camera.up()[n],
                  -camera.forward()[n], camera.position[n]);
    return std::string(text);
  };
  char angle[40];
  std::snprintf(angle, sizeof angle, "%.15g", 2 * std::atan(camera.pixel() * camera.width / 2));
  const std::string bulb_power = std::to_string(kBulbIntensity * 4 * kPi);
  return R"({"resolution": [)" + std::to_string(camera.width) + ", " + std::to_string(camera.height) +
         R"(], "pixel_aspect": [1, 1], "camera": {"type": "PERSP", "sensor_fit": "AUTO", "shift": [0, 0], "angle_x": )" +
         angle + R"(, "matrix_world": [)" + row(0) + ", " + row(1) + ", " + row(2) +
         R"(, [0, 0, 0, 1]]}, "lamps": [{"name": "bulb", "type": "POINT", "color": [1, 1, 1], "radius": 0, "energy": )" +
         bulb_power + R"(, "matrix_world": [[1, 0, 0, 3], [0, 1, 0, -3], [0, 0, 1, 4], [0, 0, 0, 1]]}]})";
}

/// A surface and a material of id 1.
inline std::string materials() {
  return R"(
surface.bumps = { generate = "spectrum", resolution = 256, rms_slope = 0.3, correlation = 8, seed = 1 }
material.a = { surface = "bumps", repeat = [4, 2], roughness = 0.1, specular = { color = [1, 0.8, 0.4] }, id = 1 }
)";
}

/// The job of the same picture. @param shape as in a job.
inline std::string job(const Camera& camera, const std::string& shape, const std::string& image = "") {
  char fov[40];
  std::snprintf(fov, sizeof fov, "%.15g", camera.fov_degrees);
  return "image = { width = " + std::to_string(camera.width) + ", height = " + std::to_string(camera.height) +
         (image.empty() ? R"(, filter = "gaussian")" : ", " + image) + R"(, aovs = ["ndf", "queries"] })" +
         "\ncamera = { position = " + text_of(camera.position) + ", look_at = [0, 0, 0], fov = " + fov +
         " }\n" + materials() + "shape = [{ " + shape + R"(, material = "a" }])" +
         "\nlight = [{ type = \"point\", position = [3, -3, 4], intensity = [25, 25, 25] }]\n";
}

}  // namespace mica::host::analytic_buffer
