#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "host/base/constants.h"
#include "host/base/printable.h"
#include "host/gbuffer/view.h"
#include "mica/error.h"

namespace mica::host {
namespace {

using nlohmann::json;

constexpr std::uintmax_t kLargestView = 16 << 20;  // bytes

/// An object of the file, which knows its place in it.
class ViewReader {
 public:
  ViewReader(const json& object, std::string file, std::string place)
      : object_(object), file_(std::move(file)), place_(std::move(place)) {
    if (!object_.is_object()) fail("", object_, "an object");
  }

  bool has(const std::string& key) const { return object_.contains(key) && !object_[key].is_null(); }

  ViewReader child(const std::string& key) const { return {get(key, "an object"), file_, path_of(key)}; }
  std::vector<ViewReader> children(const std::string& key) const {
    const json& list = get(key, "an array of objects");
    if (!list.is_array()) fail(key, list, "an array of objects");
    std::vector<ViewReader> all;
    for (std::size_t n = 0; n < list.size(); ++n)
      all.emplace_back(list[n], file_, fmt::format("{}.{}", path_of(key), n));
    return all;
  }

  std::string text(const std::string& key) const {
    const json& value = get(key, "a string");
    if (!value.is_string()) fail(key, value, "a string");
    return value;
  }
  bool flag(const std::string& key, bool otherwise) const {
    if (!has(key)) return otherwise;
    if (!object_[key].is_boolean()) fail(key, object_[key], "true or false");
    return object_[key];
  }
  double number(const std::string& key, double least, double most) const {
    const json& value = get(key, "a number");
    return number_in(key, value, least, most);
  }
  double number(const std::string& key, double otherwise, double least, double most) const {
    return has(key) ? number(key, least, most) : otherwise;
  }
  /// @param fewest of `count` numbers have to be there.
  std::vector<double> numbers(const std::string& key, std::size_t count, double least, double most) const {
    const std::string expected = fmt::format("an array of {} numbers", count);
    const json& list = get(key, expected);
    if (!list.is_array() || list.size() != count) fail(key, list, expected);
    std::vector<double> values;
    for (const json& value : list) values.push_back(number_in(key, value, least, most));
    return values;
  }
  Eigen::Matrix4d matrix(const std::string& key) const {
    const char* expected = "four rows of four numbers, of which the first three columns are no zero";
    const json& rows = get(key, expected);
    if (!rows.is_array() || rows.size() != 4) fail(key, rows, expected);
    Eigen::Matrix4d matrix;
    for (int row = 0; row < 4; ++row) {
      const json& values = rows[static_cast<std::size_t>(row)];
      if (!values.is_array() || values.size() != 4) fail(key, rows, expected);
      for (int column = 0; column < 4; ++column)
        matrix(row, column) = number_in(key, values[static_cast<std::size_t>(column)], -1e8, 1e8);
    }
    if (!(matrix.block<3, 3>(0, 0).colwise().norm().minCoeff() > 0)) fail(key, rows, expected);
    return matrix;
  }

  [[noreturn]] void fail(const std::string& key, const std::string& message) const {
    throw FileError(fmt::format("{}: {}: {}", file_, path_of(key), message));
  }

 private:
  [[noreturn]] void fail(const std::string& key, const json& found, const std::string& expected) const {
    const std::string text = found.dump(-1, ' ', false, json::error_handler_t::replace);
    fail(key, fmt::format("found {}; expected {}", printable(text.substr(0, 80)), expected));
  }
  std::string path_of(const std::string& key) const {
    if (key.empty()) return place_.empty() ? "the document" : place_;
    return place_.empty() ? key : place_ + "." + key;
  }
  const json& get(const std::string& key, const std::string& expected) const {
    if (!has(key)) fail(key, "found nothing; expected " + expected);
    return object_[key];
  }
  double number_in(const std::string& key, const json& value, double least, double most) const {
    const double number = value.is_number() ? value.get<double>() : NAN;
    if (!(number >= least && number <= most))
      fail(key, value, fmt::format("a number in [{}, {}]", least, most));
    return number;
  }

  const json& object_;
  std::string file_, place_;
};

constexpr double kMostPower = 1e12, kMostLength = 1e8;

/// What a lamp's power is multiplied with.
Color color_of(const ViewReader& lamp) {
  const std::vector<double> rgb =
      lamp.has("color") ? lamp.numbers("color", 3, 0, 1e6) : std::vector<double>{1, 1, 1};
  return Color(rgb[0], rgb[1], rgb[2]) * std::exp2(lamp.number("exposure", 0, -32, 32));
}

/// A lamp's area in the world. A lamp that is not "normalized" has its power a square unit.
double area_of(const ViewReader& lamp, const Eigen::Matrix4d& to_world) {
  const std::string shape = lamp.text("shape");
  const bool is_round = shape == "DISK" || shape == "ELLIPSE", is_even = shape == "SQUARE" || shape == "DISK";
  if (!is_round && shape != "SQUARE" && shape != "RECTANGLE")
    lamp.fail("shape", "found \"" + printable(shape) + "\"; expected SQUARE, RECTANGLE, DISK or ELLIPSE");
  const std::vector<double> size = lamp.numbers("size", 2, 0, kMostLength);
  const double sides = size[0] * (is_even ? size[0] : size[1]) * to_world.block<3, 1>(0, 0).norm() *
                       to_world.block<3, 1>(0, 1).norm();
  return is_round ? sides * kPi / 4 : sides;
}

LightDescription area_light(const ViewReader& lamp, const Eigen::Matrix4d& to_world, const Color& watts) {
  const double area = area_of(lamp, to_world);
  const Eigen::Vector3d position = to_world.block<3, 1>(0, 3);
  if (!(area > 0)) lamp.fail("size", "found no area; expected two lengths above 0");
  const Color intensity = watts / kPi * (lamp.flag("normalize", true) ? 1 : area);
  return DiskLight{position, -to_world.block<3, 1>(0, 2).normalized(), std::sqrt(area / kPi), intensity};
}

LightDescription point_light(const ViewReader& lamp, const Eigen::Matrix4d& to_world, const Color& watts) {
  const double radius = lamp.number("radius", 0, 0, kMostLength);
  const Eigen::Vector3d position = to_world.block<3, 1>(0, 3);
  // What is not "normalized" has its power a square unit of its outline.
  const double share = lamp.flag("normalize", true) || radius == 0 ? 1 : kPi * radius * radius;
  const Color intensity = watts / (4 * kPi) * share;
  if (radius > 0) return SphereLight{position, radius, intensity};
  return PointLight{position, intensity};
}

LightDescription sun_light(const ViewReader& lamp, const Eigen::Matrix4d& to_world, const Color& irradiance) {
  const double radius = lamp.number("angle", 0, 0, kPi) / 2, tangent = std::tan(std::min(radius, 1.5));
  const double share = lamp.flag("normalize", true) || radius == 0 ? 1 : kPi * tangent * tangent;
  return DirectionalLight{-to_world.block<3, 1>(0, 2).normalized(), irradiance * share, radius};
}

/// Spots of Blender before 4.0 fall with the cosine to their axis.
bool is_before_4(const ViewReader& view) {
  const int major = view.has("blender") ? std::atoi(view.text("blender").c_str()) : 0;
  return major > 0 && major < 4;
}

SpotCone spot_cone(const ViewReader& lamp, const Eigen::Matrix4d& to_world, bool falls_with_cosine) {
  const double angle = lamp.number("spot_size", 0, kPi);
  return {to_world.block<3, 1>(0, 3), -to_world.block<3, 1>(0, 2).normalized(), std::cos(angle / 2),
          lamp.number("spot_blend", 0, 0, 1), falls_with_cosine};
}

BufferLamp read_lamp(const ViewReader& reader, bool falls_with_cosine, std::vector<std::string>* notes) {
  BufferLamp lamp;
  lamp.name = reader.text("name");
  const std::string type = reader.text("type");
  const Eigen::Matrix4d to_world = reader.matrix("matrix_world");
  const Color watts = reader.number("energy", 0, kMostPower) * color_of(reader);
  if (type == "SUN") {
    lamp.light = sun_light(reader, to_world, watts);
  } else if (type == "AREA") {
    lamp.light = area_light(reader, to_world, watts);
  } else if (type == "POINT" || type == "SPOT") {
    lamp.light = point_light(reader, to_world, watts);
    if (type == "SPOT" && reader.has("spot_size")) lamp.cone = spot_cone(reader, to_world, falls_with_cosine);
    if (type == "SPOT" && !lamp.cone)
      notes->push_back("lamp " + printable(lamp.name) +
                       ": a spot without spot_size shines to all sides but where its visibility is known");
  } else {
    reader.fail("type", "found \"" + printable(type) + "\"; expected POINT, SPOT, SUN or AREA");
  }
  return lamp;
}

BufferCamera read_camera(const ViewReader& view, int width, int height) {
  const ViewReader reader = view.child("camera");
  BufferCamera::Description camera;
  const std::vector<double> aspect =
      view.has("pixel_aspect") ? view.numbers("pixel_aspect", 2, 1e-3, 1e3) : std::vector<double>{1, 1};
  camera.pixel_aspect = aspect[1] / aspect[0];
  camera.to_world = reader.matrix("matrix_world");
  if (reader.has("shift")) {
    const std::vector<double> shift = reader.numbers("shift", 2, -1e3, 1e3);
    camera.shift = {shift[0], shift[1]};
  }
  const std::string fit = reader.has("sensor_fit") ? reader.text("sensor_fit") : "AUTO";
  if (fit != "AUTO" && fit != "HORIZONTAL" && fit != "VERTICAL")
    reader.fail("sensor_fit", "found \"" + printable(fit) + "\"; expected AUTO, HORIZONTAL or VERTICAL");
  camera.fits_width = fit == "HORIZONTAL" || (fit == "AUTO" && width >= height * camera.pixel_aspect);
  const std::string type = reader.text("type");
  camera.is_orthographic = type == "ORTHO";
  if (camera.is_orthographic) {
    camera.extent = reader.number("ortho_scale", 1e-9, kMostLength);
  } else if (type == "PERSP") {
    // Blender's angle_x is that of the sensor's width, which AUTO lays along the longer side.
    const double angle = reader.number(fit == "VERTICAL" ? "angle_y" : "angle_x", 1e-6, kPi - 1e-6);
    camera.extent = 2 * std::tan(angle / 2);
  } else {
    reader.fail("type", "found \"" + printable(type) + "\"; expected PERSP or ORTHO");
  }
  return {camera, width, height};
}

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kLargestView + 1, '\0');
  if (file) file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad() || (!file && !file.eof()))
    throw FileError(path +
                    ": cannot be read; expected the camera and the lamps of the G-buffer, see --camera");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kLargestView)
    throw FileError(
        fmt::format("{}: has more than {} bytes; expected a camera and lamps", path, kLargestView));
  return text;
}

}  // namespace

BufferView read_view(const std::string& path) {
  json document;
  try {
    document = json::parse(text_of(path));
  } catch (const json::exception& error) {
    throw FileError(path + ": is no JSON: " + printable(error.what()));
  }
  const ViewReader reader(document, path, "");
  const std::vector<double> resolution = reader.numbers("resolution", 2, 1, 65536);
  const int width = static_cast<int>(resolution[0]), height = static_cast<int>(resolution[1]);
  BufferView view{width, height, read_camera(reader, width, height), {}, {}};
  const bool spots_fall = is_before_4(reader);
  for (const ViewReader& lamp : reader.children("lamps"))
    view.lamps.push_back(read_lamp(lamp, spots_fall, &view.notes));
  if (view.lamps.empty())
    reader.fail("lamps", "found none; expected at least one lamp: glints are its mirror images");
  return view;
}

}  // namespace mica::host
