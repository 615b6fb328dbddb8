#include <functional>

#include "host/job/read_job.h"
#include "host/job/read_keyframes.h"

namespace mica::host {
namespace {

const Interval kPower = closed(0, 1e9);

void read_direction(TableReader& light, Eigen::Vector3d& direction, std::string_view meaning) {
  light.read("direction", direction, kCoordinate);
  if (direction.norm() < 1e-9) light.report("direction", meaning);
}

// What each kind of light can be told.

void read_values(TableReader& light, PointLight& point) {
  light.read("position", point.position, kCoordinate);
  light.read("intensity", point.intensity, kPower);
}

void read_values(TableReader& light, DirectionalLight& directional) {
  read_direction(light, directional.direction,
                 "found no length; expected the direction in which the light travels");
  light.read("irradiance", directional.irradiance, kPower);
}

void read_values(TableReader& light, SphereLight& sphere) {
  light.read("position", sphere.position, kCoordinate);
  light.read("radius", sphere.radius, kExtent);
  light.read("intensity", sphere.intensity, kPower);
}

void read_values(TableReader& light, DiskLight& disk) {
  light.read("position", disk.position, kCoordinate);
  read_direction(light, disk.direction, "found no length; expected the direction that the disk faces");
  light.read("radius", disk.radius, kExtent);
  light.read("intensity", disk.intensity, kPower);
}

void read_lamp(const LightDescription& kind, TableReader& light, SceneDescription& scene) {
  LightDescription lamp = kind;
  const char* place = std::holds_alternative<DirectionalLight>(lamp) ? "direction" : "position";
  light.require(place, "an array of 3 numbers");
  const auto read = [](TableReader& table, LightDescription& described) {
    std::visit([&](auto& values) { read_values(table, values); }, described);
  };
  read(light, lamp);
  scene.light_keys.push_back(read_keyframes(light, lamp, read));
  scene.lights.push_back(lamp);
}

EnvironmentLight make_environment(TableReader& light) {
  EnvironmentLight environment;
  light.require("image", "a lat-long EXR or HDR image");
  light.read_file("image", environment.path);
  light.read_choice(environment.choice);
  light.read("invalid", environment.invalid);
  light.read("scale", environment.radiance, kPower);
  light.read("rotation", environment.rotation_degrees, closed(-360, 360));
  return environment;
}

EnvironmentLight make_furnace(TableReader& light) {
  EnvironmentLight furnace;
  light.read("radiance", furnace.radiance, kPower);
  return furnace;
}

/// A light of the kind that "type" names; nothing, with a report, when that is not clear.
void read_light(TableReader& light, SceneDescription& scene) {
  using Make = std::function<void()>;
  const auto lamp = [&](const LightDescription& kind) {
    return Make([&light, &scene, kind] { read_lamp(kind, light, scene); });
  };
  const auto far = [&](EnvironmentLight (*make)(TableReader&)) {
    return Make([&light, &scene, make] { scene.environments.push_back(make(light)); });
  };
  Make make;
  light.require("type", "one of: point, directional, sphere, disk, environment, furnace");
  light.read("type", make,
             {{"point", lamp(PointLight{})},
              {"directional", lamp(DirectionalLight{})},
              {"sphere", lamp(SphereLight{})},
              {"disk", lamp(DiskLight{})},
              {"environment", far(make_environment)},
              {"furnace", far(make_furnace)}});
  if (make) {
    make();
  } else {
    light.accept_any_key();
  }
}

}  // namespace

void read_lights(TableReader& job, SceneDescription& scene) {
  job.read_table_array("light", [&](TableReader& light) { read_light(light, scene); });
}

}  // namespace mica::host
