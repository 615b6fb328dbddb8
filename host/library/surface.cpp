#include "mica/surface.h"

#include <fmt/format.h>

#include <cmath>

#include "host/image/image_header.h"
#include "host/job/read_surface.h"
#include "host/surface/disk.h"
#include "host/surface/surface.h"
#include "mica/error.h"

MICA_BEGIN_NAMESPACE
namespace {

NormalMap make_map(const char* source, const std::string& what, const Settings& settings) {
  std::vector<std::pair<std::string, std::string>> keys = {{source, "'''" + what + "'''"}};
  for (const auto& [key, value] : settings) keys.emplace_back(key, value.text());
  host::SurfaceReport report;
  auto surface = std::make_shared<host::Surface>(host::make_surface(host::read_surface(keys), &report));
  std::vector<std::string> notes = report.notes;
  notes.insert(notes.end(), report.warnings.begin(), report.warnings.end());
  return NormalMap(std::move(surface), std::move(notes));
}

template <typename T>
Eigen::Vector2d normal_at(const T* numbers, int channels, std::size_t texel, int width) {
  const auto refuse = [&](const char* expected) {
    throw UsageError(fmt::format("normal of texel ({}, {}): expected {}",
                                 texel % static_cast<std::size_t>(width),
                                 texel / static_cast<std::size_t>(width), expected));
  };
  for (int n = 0; n < channels; ++n)
    if (!std::isfinite(numbers[n])) refuse("finite numbers");
  Eigen::Vector2d s(numbers[0], numbers[1]);
  if (channels == 3) {
    const double length = std::hypot(s.x(), s.y(), static_cast<double>(numbers[2]));
    if (!(length > 0)) refuse("a normal of some length");
    if (!(numbers[2] > 0)) refuse("a normal that points up, z > 0");
    s /= length;
  }
  if (!(s.squaredNorm() < 1)) refuse("s^2 + t^2 below 1");
  return s.norm() > host::kRim ? Eigen::Vector2d(s * (host::kRim / s.norm())) : s;
}

template <typename T>
NormalMap map_of(int width, int height, Span<const T> normals, int channels, Interpolation interpolation) {
  if (channels != 2 && channels != 3)
    throw UsageError(fmt::format("normals of {} channels; expected 2 (s, t) or 3 (x, y, z)", channels));
  constexpr int largest = 32768;
  if (width < 1 || height < 1 || width > largest || height > largest)
    throw UsageError(fmt::format("a map of {} x {} texels; expected 1 to {} a side", width, height, largest));
  const std::size_t texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (normals.data == nullptr || normals.size != texels * static_cast<std::size_t>(channels))
    throw UsageError(fmt::format("a map of {} x {} texels and {} channels was given {} numbers", width,
                                 height, channels, normals.data == nullptr ? 0 : normals.size));
  std::vector<Eigen::Vector2d> disk(texels);
  for (std::size_t n = 0; n < texels; ++n)
    disk[n] = normal_at(normals.data + n * static_cast<std::size_t>(channels), channels, n, width);
  return NormalMap(std::make_shared<host::Surface>(
      width, height, static_cast<host::Interpolation>(interpolation), std::move(disk)));
}

template <typename T>
void copy_to(const host::Surface& surface, Span<T> normals) {
  if (normals.data == nullptr || normals.size != 2 * surface.normals().size())
    throw UsageError(fmt::format("normals: found room for {} numbers; expected {}",
                                 normals.data == nullptr ? 0 : normals.size, 2 * surface.normals().size()));
  for (std::size_t n = 0; n < surface.normals().size(); ++n) {
    normals[2 * n] = static_cast<T>(surface.normals()[n].x());
    normals[2 * n + 1] = static_cast<T>(surface.normals()[n].y());
  }
}

}  // namespace

NormalMap NormalMap::load(const std::string& path, const Settings& settings) {
  host::identify_image(path);  // a job calls a file that is missing a mistake of its own
  return make_map("file", path, settings);
}

NormalMap NormalMap::generate(const std::string& kind, const Settings& settings) {
  return make_map("generate", kind, settings);
}

NormalMap NormalMap::from_normals(int width, int height, Span<const float> normals, int channels,
                                  Interpolation interpolation) {
  return map_of(width, height, normals, channels, interpolation);
}

NormalMap NormalMap::from_normals(int width, int height, Span<const double> normals, int channels,
                                  Interpolation interpolation) {
  return map_of(width, height, normals, channels, interpolation);
}

NormalMap::NormalMap(std::shared_ptr<const host::Surface> surface, std::vector<std::string> notes)
    : implementation_(std::move(surface)), notes_(std::move(notes)) {}

const std::shared_ptr<const host::Surface>& NormalMap::implementation() const {
  if (!implementation_) throw UsageError("normal map: found one that was moved from; expected a map");
  return implementation_;
}

int NormalMap::width() const {
  return implementation()->width();
}

int NormalMap::height() const {
  return implementation()->height();
}

Interpolation NormalMap::interpolation() const {
  return static_cast<Interpolation>(implementation()->interpolation());
}

Span<const double> NormalMap::normals() const {
  static_assert(sizeof(Eigen::Vector2d) == 2 * sizeof(double), "normals are plain numbers");
  const std::vector<Eigen::Vector2d>& normals = implementation()->normals();
  return {normals.front().data(), 2 * normals.size()};
}

void NormalMap::copy_normals(Span<float> normals) const {
  copy_to(*implementation(), normals);
}

void NormalMap::copy_normals(Span<double> normals) const {
  copy_to(*implementation(), normals);
}

MICA_END_NAMESPACE
