#include "host/gbuffer/gbuffer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "host/base/printable.h"
#include "host/scene/footprint.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr char kUnfiltered[] =
    "expected one sample through each pixel's centre: render the G-buffer with 1 sample and a filter that is "
    "narrow (in Cycles filter_width 0.01), and without denoising";

bool has(const BufferChannels& channels, BufferRole role) {
  return !channels[static_cast<std::size_t>(role)].empty();
}

/// What channels of derivatives say of a pixel; zero where there are none.
struct Derivatives {
  Eigen::Vector2f uv_dx{0, 0}, uv_dy{0, 0};  ///< of uv, a pixel to the right and one down
  Eigen::Vector3f dp_du{0, 0, 0}, dp_dv{0, 0, 0};
};

/// As BufferPixel::dpduv: where only uv's change is known, the camera tells that of the position.
Eigen::Matrix<float, 3, 2> position_change(const Derivatives& derivatives, const BufferPixel& pixel,
                                           const BufferCamera& camera) {
  constexpr double least = 1e-6;  // of the sine between both directions
  Eigen::Matrix<double, 3, 2> change;
  change << derivatives.dp_du.cast<double>(), derivatives.dp_dv.cast<double>();
  Eigen::Matrix2d duv;
  duv << derivatives.uv_dx.cast<double>(), derivatives.uv_dy.cast<double>();
  if (change.isZero(0) && std::abs(duv.determinant()) > least * duv.squaredNorm()) {
    Hit hit;
    hit.face_normal = pixel.face_normal.cast<double>();
    const BufferCamera::Sight sight = camera.sight(pixel.position.cast<double>());
    hit.t = sight.t;
    change = position_differentials(sight.ray, hit) * duv.inverse();
  }
  const double area = change.col(0).cross(change.col(1)).norm();
  if (!change.allFinite() || !(area > least * change.squaredNorm())) change.setZero();
  return change.cast<float>();
}

void check_resolution(const ChannelFile& file, const BufferView& view, int scale) {
  const FileWindow& window = file.window();
  if (window.whole_width != view.width || window.whole_height != view.height)
    throw FileError(
        fmt::format("{}: has {} x {} pixels, and its camera {} x {}; expected those of one render",
                    file.path(), window.whole_width, window.whole_height, view.width, view.height));
  for (const int size :
       {window.width, window.height, window.left, window.top, window.whole_width, window.whole_height})
    if (size % scale != 0)
      throw FileError(
          fmt::format("{}: has {} x {} pixels at ({}, {}) of {} x {}; expected multiples of the scale {}",
                      file.path(), window.width, window.height, window.left, window.top, window.whole_width,
                      window.whole_height, scale));
}

}  // namespace

GBuffer::GBuffer(const std::string& path, const BufferView& view,
                 const std::vector<MaterialDescription>& materials, int scale, const BufferOptions& options)
    : file_(path),
      camera_(view.camera),
      channels_(find_buffer_channels(file_, options.presets, options.channels)) {
  check_resolution(file_, view, scale);
  if (!has(channels_, BufferRole::tangent) && !has(channels_, BufferRole::dp_du))
    notes_.push_back(path +
                     ": has no tangents; they are those of uv and position, which facets of a mesh break");
  find_lamps(view);
  read_ids(materials, options.skips_other_ids);
}

void GBuffer::find_lamps(const BufferView& view) {
  std::vector<std::string> unknown;
  for (const BufferLamp& lamp : view.lamps) {
    lamp_channels_.push_back(find_lamp_channels(file_, lamp.name));
    if (lamp_channels_.back().empty()) unknown.push_back(printable(lamp.name));
  }
  if (!unknown.empty())
    notes_.push_back(
        fmt::format("{}: has no channels Lamps.Combined_LAMP of {}, whose light is taken as without shadows",
                    file_.path(), fmt::join(unknown, ", ")));
}

/// All of them before anything is built: a mistake here is told with all ids that there are.
void GBuffer::read_ids(const std::vector<MaterialDescription>& materials, bool skips_other_ids) {
  for (std::size_t n = 0; n < materials.size(); ++n)
    if (materials[n].id) material_of_id_[*materials[n].id] = static_cast<std::int32_t>(n);
  constexpr int rows_at_once = 64;
  const int width = window().width, height = window().height;
  std::map<std::int64_t, std::size_t> counts;
  for (int first = 0; first < height; first += rows_at_once) {
    const std::vector<float> ids = file_.read(first, std::min(rows_at_once, height - first),
                                              channels_[static_cast<std::size_t>(BufferRole::id)]);
    for (std::size_t n = 0; n < ids.size(); ++n) {
      if (!(std::abs(ids[n]) < 1e9f) || ids[n] != std::round(ids[n]))
        throw FileError(fmt::format("{}: {} has the id {}, which is no whole number; {}", file_.path(),
                                    place(first + static_cast<int>(n) / width, static_cast<int>(n) % width),
                                    ids[n], kUnfiltered));
      ++counts[static_cast<std::int64_t>(ids[n])];
    }
  }
  std::vector<std::string> found, other;
  for (const auto& [id, count] : counts) {
    if (id == 0) continue;
    found.push_back(fmt::format("{} ({} pixels)", id, count));
    if (material_of_id_.count(id) == 0) other.push_back(fmt::format("{}", id));
  }
  const std::string text = fmt::format("{}: found the ids {}", file_.path(), fmt::join(found, ", "));
  if (!other.empty() && !skips_other_ids)
    throw FileError(
        fmt::format("{}; no material has `id = {}`: give it one, or leave those out by --other-ids skip",
                    text, fmt::join(other, "`, `id = ")));
  notes_.push_back(found.empty() ? file_.path() + ": found no id but 0: there is nothing to glint" : text);
}

std::string GBuffer::place(int row, int column) const {
  return fmt::format("pixel ({}, {}) from the top left", column, row);
}

std::int32_t GBuffer::material_of(float id, int row, int column) const {
  if (!(std::abs(id) < 1e9f))
    throw FileError(fmt::format("{}: {} has the id {}", file_.path(), place(row, column), id));
  const auto found = material_of_id_.find(static_cast<std::int64_t>(id));
  return id == 0 || found == material_of_id_.end() ? BufferPixel::kNothing : found->second;
}

/// @param values of all roles that are there, in their order.
BufferPixel GBuffer::pixel_of(const float* values, int row, int column) const {
  constexpr float most_off = 5e-3f;  // of a normal's length: half floats are by 1e-3
  BufferPixel pixel;
  const auto next = [&](BufferRole role, auto* vector) {
    if (!has(channels_, role)) return false;
    for (Eigen::Index n = 0; n < vector->size(); ++n) (*vector)[n] = *values++;
    return true;
  };
  next(BufferRole::position, &pixel.position);
  next(BufferRole::normal, &pixel.normal);
  if (!next(BufferRole::true_normal, &pixel.face_normal)) pixel.face_normal = pixel.normal;
  next(BufferRole::tangent, &pixel.tangent);
  next(BufferRole::uv, &pixel.uv);
  Derivatives derivatives;
  next(BufferRole::uv_dx, &derivatives.uv_dx), next(BufferRole::uv_dy, &derivatives.uv_dy);
  next(BufferRole::dp_du, &derivatives.dp_du), next(BufferRole::dp_dv, &derivatives.dp_dv);
  if (!has(channels_, BufferRole::tangent)) pixel.tangent = derivatives.dp_du;
  pixel.material = material_of(*values, row, column);
  if (pixel.material == BufferPixel::kNothing) return {};
  if (!pixel.position.allFinite() || !pixel.normal.allFinite() || !pixel.face_normal.allFinite() ||
      !pixel.uv.allFinite()) {
    pixel = {};
    pixel.is_broken = true;
    return pixel;
  }
  if (!pixel.tangent.allFinite()) pixel.tangent.setZero();
  for (Eigen::Vector3f* normal : {&pixel.normal, &pixel.face_normal}) {
    const float length = normal->norm();
    if (!(std::abs(length - 1) <= most_off))
      throw FileError(fmt::format("{}: {} has a normal of length {}, as an average of several; {}",
                                  file_.path(), place(row, column), length, kUnfiltered));
    *normal /= length;
  }
  check_place(pixel, row, column);
  pixel.dpduv = position_change(derivatives, pixel, camera_);
  return pixel;
}

void GBuffer::check_place(const BufferPixel& pixel, int row, int column) const {
  constexpr double most_off = 1;  // pixel
  const Eigen::Vector2d center(window().left + column + 0.5, window().top + row + 0.5);
  const std::optional<Eigen::Vector2d> seen = camera_.project(pixel.position.cast<double>());
  if (seen && (*seen - center).cwiseAbs().maxCoeff() <= most_off) return;
  throw FileError(
      fmt::format("{}: the position of {} is {}; expected the camera that made the G-buffer, and a pinhole "
                  "(no depth of field)",
                  file_.path(), place(row, column),
                  seen ? fmt::format("seen by its camera at ({:.2f}, {:.2f})", seen->x(), seen->y())
                       : "behind its camera"));
}

BufferRows GBuffer::read(int first_row, int row_count, int margin) {
  const int width = window().width;
  BufferRows rows{{first_row, row_count, -margin, width + 2 * margin}, {}};
  for (const std::vector<int>& channels : lamp_channels_)
    rows.lamp_light.emplace_back(first_row, channels.empty() ? 0 : row_count, 0, width);
  const int begin = std::max(first_row, 0), end = std::min(first_row + row_count, window().height);
  if (begin >= end) return rows;
  std::vector<int> wanted;
  for (const std::vector<int>& places : channels_) wanted.insert(wanted.end(), places.begin(), places.end());
  const std::size_t attributes = wanted.size();
  for (const std::vector<int>& places : lamp_channels_)
    wanted.insert(wanted.end(), places.begin(), places.end());
  const std::vector<float> values = file_.read(begin, end - begin, wanted);
  const float* here = values.data();
  for (int row = begin; row < end; ++row)
    for (int column = 0; column < width; ++column, here += wanted.size()) {
      rows.pixels.at(row, column) = pixel_of(here, row, column);
      const float* light = here + attributes;
      for (std::size_t lamp = 0; lamp < lamp_channels_.size(); ++lamp) {
        if (lamp_channels_[lamp].empty()) continue;
        rows.lamp_light[lamp].at(row, column) = light[0] + light[1] + light[2];
        light += 3;
      }
    }
  return rows;
}

}  // namespace mica::host
