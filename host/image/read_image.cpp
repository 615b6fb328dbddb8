#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/image/image.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// IEC 61966-2-1.
float linear_from_srgb(float value) {
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

/// Integers have sRGB's curve unless the file says another gamma.
void make_linear(Picture* picture) {
  if (picture->type == Picture::Type::floating || picture->gamma == 1) return;
  const float gamma = static_cast<float>(picture->gamma);
  for (float& value : picture->pixels) value = gamma > 0 ? std::pow(value, gamma) : linear_from_srgb(value);
}

Image linear_rgb(const std::string& path, const PictureChoice& choice, Findings* findings) {
  Picture picture = read_picture(path, choice, PictureUse::color, findings);
  make_linear(&picture);
  Image image{picture.width, picture.height, {"R", "G", "B"}, {}, {}};
  if (picture.channels.size() == 3) {
    image.pixels = std::move(picture.pixels);
    return image;
  }
  image.pixels.reserve(3 * picture.pixels.size());
  for (const float grey : picture.pixels) image.pixels.insert(image.pixels.end(), 3, grey);
  return image;
}

/// "pixel (3, 1) from the top left"
std::string place(const Image& image, std::size_t value) {
  const std::size_t pixel = value / image.channels.size(), width = static_cast<std::size_t>(image.width);
  return fmt::format("pixel ({}, {}) from the top left", pixel % width, pixel / width);
}

template <class Predicate>
void refuse_if_any(const std::string& path, const Image& image, const Predicate& is_bad,
                   const char* expected) {
  const auto bad = std::find_if(image.pixels.begin(), image.pixels.end(), is_bad);
  if (bad == image.pixels.end()) return;
  const auto value = static_cast<std::size_t>(bad - image.pixels.begin());
  throw FileError(fmt::format("{}: {} is {}, expected {}", path, place(image, value), *bad, expected));
}

/// What infinities become: the greatest half float, which they outgrew, or what else the image has above it.
float greatest_finite(const Image& image) {
  float greatest = 65504;
  for (const float value : image.pixels)
    if (std::isfinite(value)) greatest = std::max(greatest, value);
  return greatest;
}

template <class Predicate>
void replace_and_say(const std::string& path, Image* image, const Predicate& is_bad, float by,
                     const char* what, std::vector<std::string>* notes) {
  std::size_t count = 0, first = 0;
  for (std::size_t n = image->pixels.size(); n-- > 0;)
    if (is_bad(image->pixels[n])) image->pixels[n] = by, first = n, ++count;
  if (count > 0)
    notes->push_back(fmt::format("{}: {} of {} values are {} (the first in {}); taken as {}", path, count,
                                 image->pixels.size(), what, place(*image, first), by));
}

bool is_negative(float value) {
  return value < 0;
}
bool is_too_bright(float value) {
  return std::isinf(value) && value > 0;
}

}  // namespace

Image read_rgb(const std::string& path, const PictureChoice& choice, Findings* findings) {
  const Image image = linear_rgb(path, choice, findings);
  refuse_if_any(
      path, image, [](float value) { return !std::isfinite(value); }, "finite values");
  return image;
}

Image read_radiance(const std::string& path, const PictureChoice& choice, TexelRepair invalid,
                    Findings* findings) {
  Findings said;
  Image image = linear_rgb(path, choice, &said);
  for (std::string& note : said.notes) note = path + ": " + note;
  if (invalid == TexelRepair::repair) {
    replace_and_say(path, &image, is_too_bright, greatest_finite(image), "infinite", &said.notes);
    replace_and_say(path, &image, is_negative, 0, "negative", &said.notes);
  }
  refuse_if_any(
      path, image, [](float value) { return !std::isfinite(value); }, "finite values");
  refuse_if_any(path, image, is_negative, "radiance, which is not negative");
  if (findings) {
    findings->notes.insert(findings->notes.end(), said.notes.begin(), said.notes.end());
    findings->warnings.insert(findings->warnings.end(), said.warnings.begin(), said.warnings.end());
  }
  return image;
}

}  // namespace mica::host
