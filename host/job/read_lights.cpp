#include <optional>

#include "host/job/read_job.h"

namespace mica {
namespace {

const Interval coordinate = closed(-1e6, 1e6);
const Interval power = closed(0, 1e9);
const Interval extent = open_low(0, 1e6);

void read_direction(TableReader& light, Eigen::Vector3d& direction, std::string_view meaning) {
  light.read("direction", direction, coordinate);
  if (direction.norm() < 1e-9) light.report("direction", meaning);
}

// What each kind of light can be told.

void read_values(TableReader& light, PointLight& point) {
  light.read("position", point.position, coordinate);
  light.read("intensity", point.intensity, power);
}

void read_values(TableReader& light, DirectionalLight& directional) {
  read_direction(light, directional.direction,
                 "found no length; expected the direction in which the light travels");
  light.read("irradiance", directional.irradiance, power);
}

void read_values(TableReader& light, SphereLight& sphere) {
  light.read("position", sphere.position, coordinate);
  light.read("radius", sphere.radius, extent);
  light.read("intensity", sphere.intensity, power);
}

void read_values(TableReader& light, DiskLight& disk) {
  light.read("position", disk.position, coordinate);
  read_direction(light, disk.direction, "found no length; expected the direction that the disk faces");
  light.read("radius", disk.radius, extent);
  light.read("intensity", disk.intensity, power);
}

/// A light of the kind that "type" names; nothing, with a report, when that is not clear.
std::optional<LightDescription> read_kind(TableReader& light) {
  const LightDescription point = PointLight{}, directional = DirectionalLight{}, sphere = SphereLight{},
                         disk = DiskLight{};
  const LightDescription* kind = nullptr;
  light.require("type", "one of: point, directional, sphere, disk");
  light.read("type", kind,
             {{"point", &point}, {"directional", &directional}, {"sphere", &sphere}, {"disk", &disk}});
  return kind ? std::optional<LightDescription>(*kind) : std::nullopt;
}

LightDescription read_light(TableReader& light) {
  std::optional<LightDescription> kind = read_kind(light);
  if (!kind) {
    light.accept_any_key();
    return PointLight{};
  }
  const char* place = std::holds_alternative<DirectionalLight>(*kind) ? "direction" : "position";
  light.require(place, "an array of 3 numbers");
  std::visit([&](auto& described) { read_values(light, described); }, *kind);
  return *kind;
}

}  // namespace

std::vector<LightDescription> read_lights(TableReader& job) {
  std::vector<LightDescription> lights;
  job.read_table_array("light", [&](TableReader& light) { lights.push_back(read_light(light)); });
  return lights;
}

}  // namespace mica
