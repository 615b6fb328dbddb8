#include <Eigen/Geometry>

#include "host/job/read_job.h"
#include "host/job/read_keyframes.h"

namespace mica::host {
namespace {

// Far inside what single precision, in which rays are traced, tells apart from infinity.
const Interval kRadiance = closed(0, 1e9);

void read_camera(TableReader& table, CameraDescription& camera) {
  table.read("position", camera.position, kCoordinate);
  table.read("look_at", camera.look_at, kCoordinate);
  table.read("up", camera.up, kCoordinate);
  table.read("fov", camera.fov_degrees, open(0, 180));

  const Eigen::Vector3d forward = camera.look_at - camera.position;
  if (forward.norm() < 1e-9) {
    table.report("look_at", "found the camera's position; expected another point");
  } else if (forward.normalized().cross(camera.up.stableNormalized()).norm() < 1e-6) {
    table.report("up", "found no direction across the view; expected one that is not parallel to it");
  }
}

using Geometry = decltype(ShapeDescription::geometry);

Geometry read_sphere(TableReader& shape) {
  SphereShape sphere;
  shape.read("center", sphere.center, kCoordinate);
  shape.read("radius", sphere.radius, kExtent);
  return sphere;
}

Geometry read_shell(TableReader& shape) {
  ShellShape shell;
  shape.read("center", shell.center, kCoordinate);
  shape.read("size", shell.size, kExtent);
  shape.read("turns", shell.turns, closed(1, 12));
  return shell;
}

Geometry read_mesh(TableReader& shape) {
  MeshShape mesh;
  shape.require("file", "a Wavefront OBJ file");
  shape.read_file("file", mesh.path);
  return mesh;
}

/// Any of the parametric shapes that are described by where they stand and how large they are.
template <typename Shape>
Geometry read_sized(TableReader& table) {
  Shape shape;
  table.read("center", shape.center, kCoordinate);
  table.read("size", shape.size, kExtent);
  return shape;
}

void read_placement(TableReader& shape, Placement& placement) {
  shape.read("scale", placement.scale, closed(1e-6, 1e6));
  shape.read("rotate", placement.rotate_degrees, closed(-360, 360));
  shape.read("translate", placement.translate, kCoordinate);
}

PartMaterial read_part(TableReader& table, const std::vector<std::string_view>& material_names) {
  PartMaterial part;
  table.require("name", "the name of a part of the shape");
  table.read("name", part.part);
  table.require("material", "the name of a material");
  table.read_reference("material", part.material, "material", material_names);
  return part;
}

void read_shape(TableReader& table, ShapeDescription& shape,
                const std::vector<std::string_view>& material_names) {
  Geometry (*read_geometry)(TableReader&) = nullptr;
  table.require("type", "one of: plane, sphere, shell, jar, spoon, fork, mesh");
  table.read("type", read_geometry,
             {{"plane", read_sized<PlaneShape>},
              {"sphere", read_sphere},
              {"shell", read_shell},
              {"jar", read_sized<JarShape>},
              {"spoon", read_sized<SpoonShape>},
              {"fork", read_sized<ForkShape>},
              {"mesh", read_mesh}});
  table.require("material", "the name of a material");
  table.read_reference("material", shape.material, "material", material_names);
  read_placement(table, shape.placement);
  if (table.has("parts"))
    table.read_table_array(
        "parts", [&](TableReader& part) { shape.parts.push_back(read_part(part, material_names)); });
  if (read_geometry) {
    shape.geometry = read_geometry(table);
  } else {
    table.accept_any_key();
  }
}

void read_background(TableReader& table, BackgroundDescription& background) {
  table.read("color", background.color, kRadiance);
  table.read_file("image", background.path);
  if (table.has("image")) {
    table.read_choice(background.choice);
    table.read("invalid", background.invalid);
  }
  if (table.has("color") && table.has("image")) {
    table.report("image", "found an image beside a color; expected one of them");
  }
}

}  // namespace

SceneDescription read_scene(TableReader& job, const std::vector<SurfaceDescription>& surfaces,
                            const MethodRegistry& methods) {
  SceneDescription scene;
  job.read_table("camera", [&](TableReader& table) {
    read_camera(table, scene.camera);
    scene.camera_keys = read_keyframes(table, scene.camera, read_camera);
  });
  scene.materials = read_materials(job, surfaces, methods);
  std::vector<std::string_view> material_names;
  for (const MaterialDescription& material : scene.materials) material_names.push_back(material.name);
  job.read_table_array(
      "shape", [&](TableReader& table) { read_shape(table, scene.shapes.emplace_back(), material_names); });
  read_lights(job, scene);
  scene.background.is_environment = !scene.environments.empty() && !job.has("background");
  job.read_table("background", [&](TableReader& table) { read_background(table, scene.background); });
  return scene;
}

}  // namespace mica::host
