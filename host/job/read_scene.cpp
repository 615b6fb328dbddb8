#include <Eigen/Geometry>

#include "host/job/read_job.h"

namespace mica {
namespace {

// Far inside what single precision, in which rays are traced, tells apart from infinity.
const Interval coordinate = closed(-1e6, 1e6);
const Interval extent = open_low(0, 1e6);
const Interval radiance = closed(0, 1e9);

void read_camera(TableReader& table, CameraDescription& camera) {
  table.read("position", camera.position, coordinate);
  table.read("look_at", camera.look_at, coordinate);
  table.read("up", camera.up, coordinate);
  table.read("fov", camera.fov_degrees, open(0, 180));

  const Eigen::Vector3d forward = camera.look_at - camera.position;
  if (forward.norm() < 1e-9) {
    table.report("look_at", "found the camera's position; expected another point");
  } else if (forward.normalized().cross(camera.up.stableNormalized()).norm() < 1e-6) {
    table.report("up", "found no direction across the view; expected one that is not parallel to it");
  }
}

using Geometry = decltype(ShapeDescription::geometry);

Geometry read_plane(TableReader& shape) {
  PlaneShape plane;
  shape.read("center", plane.center, coordinate);
  shape.read("size", plane.size, extent);
  return plane;
}

Geometry read_sphere(TableReader& shape) {
  SphereShape sphere;
  shape.read("center", sphere.center, coordinate);
  shape.read("radius", sphere.radius, extent);
  return sphere;
}

Geometry read_shell(TableReader& shape) {
  ShellShape shell;
  shape.read("center", shell.center, coordinate);
  shape.read("size", shell.size, extent);
  shape.read("turns", shell.turns, closed(1, 12));
  return shell;
}

Geometry read_mesh(TableReader& shape) {
  MeshShape mesh;
  shape.require("file", "a Wavefront OBJ file");
  shape.read_file("file", mesh.path);
  return mesh;
}

void read_shape(TableReader& table, ShapeDescription& shape,
                const std::vector<std::string_view>& material_names) {
  Geometry (*read_geometry)(TableReader&) = nullptr;
  table.require("type", "one of: plane, sphere, shell, mesh");
  table.read("type", read_geometry,
             {{"plane", read_plane}, {"sphere", read_sphere}, {"shell", read_shell}, {"mesh", read_mesh}});
  table.require("material", "the name of a material");
  table.read_reference("material", shape.material, "material", material_names);
  if (read_geometry) {
    shape.geometry = read_geometry(table);
  } else {
    table.accept_any_key();
  }
}

void read_point(TableReader& light, SceneDescription& scene) {
  PointLight point;
  light.require("position", "an array of 3 numbers");
  light.read("position", point.position, coordinate);
  light.read("intensity", point.intensity, radiance);
  scene.lights.emplace_back(point);
}

void read_directional(TableReader& light, SceneDescription& scene) {
  DirectionalLight directional;
  light.require("direction", "an array of 3 numbers");
  light.read("direction", directional.direction, coordinate);
  if (directional.direction.norm() < 1e-9) {
    light.report("direction", "found no length; expected the direction in which the light travels");
  }
  light.read("irradiance", directional.irradiance, radiance);
  scene.lights.emplace_back(directional);
}

void read_environment(TableReader& light, SceneDescription& scene) {
  EnvironmentLight environment;
  light.require("image", "a lat-long EXR or HDR image");
  light.read_file("image", environment.path);
  light.read("scale", environment.radiance, radiance);
  light.read("rotation", environment.rotation_degrees, closed(-360, 360));
  scene.environments.push_back(environment);
}

void read_furnace(TableReader& light, SceneDescription& scene) {
  EnvironmentLight furnace;
  light.read("radiance", furnace.radiance, radiance);
  scene.environments.push_back(furnace);
}

void read_light(TableReader& table, SceneDescription& scene) {
  void (*read)(TableReader&, SceneDescription&) = nullptr;
  table.require("type", "one of: point, directional, environment, furnace");
  table.read("type", read,
             {{"point", read_point},
              {"directional", read_directional},
              {"environment", read_environment},
              {"furnace", read_furnace}});
  if (read) {
    read(table, scene);
  } else {
    table.accept_any_key();
  }
}

void read_background(TableReader& table, BackgroundDescription& background) {
  table.read("color", background.color, radiance);
  table.read_file("image", background.path);
  if (table.has("color") && table.has("image")) {
    table.report("image", "found an image beside a color; expected one of them");
  }
}

}  // namespace

SceneDescription read_scene(TableReader& job, const std::vector<SurfaceDescription>& surfaces) {
  SceneDescription scene;
  job.read_table("camera", [&](TableReader& table) { read_camera(table, scene.camera); });
  scene.materials = read_materials(job, surfaces);
  std::vector<std::string_view> material_names;
  for (const MaterialDescription& material : scene.materials) material_names.push_back(material.name);
  job.read_table_array(
      "shape", [&](TableReader& table) { read_shape(table, scene.shapes.emplace_back(), material_names); });
  job.read_table_array("light", [&](TableReader& table) { read_light(table, scene); });
  scene.background.is_environment = !scene.environments.empty() && !job.has("background");
  job.read_table("background", [&](TableReader& table) { read_background(table, scene.background); });
  return scene;
}

}  // namespace mica
