#include "host/report/page_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/report/svg.h"

namespace mica::host {
namespace {

std::string tag(const std::string& png, int width, int height, int zoom, const std::string& caption) {
  return fmt::format("<img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">",
                     width * zoom, height * zoom, escape_markup(caption), base64(png));
}

std::uint8_t byte(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

}  // namespace

std::string base64(const std::string& bytes) {
  static const char* const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t n = 0; n < bytes.size(); n += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (n + k < bytes.size() ? static_cast<unsigned char>(bytes[n + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += n + k > bytes.size() ? '=' : letters[three >> (18 - 6 * k) & 63u];
  }
  return text;
}

std::string image_tag(int width, int height, const std::vector<std::uint8_t>& srgb, int zoom,
                      const std::string& caption) {
  return tag(encode_png(width, height, srgb), width, height, zoom, caption);
}

std::vector<std::uint8_t> grey_pixels(const std::vector<float>& values, double white) {
  std::vector<std::uint8_t> pixels;
  for (const float value : values)
    pixels.insert(pixels.end(), 3, byte(std::sqrt(std::max(0.0, value / std::max(white, 1e-30)))));
  return pixels;
}

std::vector<std::uint8_t> difference_pixels(const std::vector<float>& values,
                                            const std::vector<float>& reference, double limit) {
  constexpr double orange[] = {0.835, 0.369, 0}, blue[] = {0, 0.447, 0.698};
  std::vector<std::uint8_t> pixels;
  for (std::size_t n = 0; n < values.size(); ++n) {
    const double share = std::clamp((values[n] - reference[n]) / std::max(limit, 1e-30), -1.0, 1.0);
    for (int c = 0; c < 3; ++c)
      pixels.push_back(byte(1 + std::abs(share) * ((share > 0 ? orange : blue)[c] - 1)));
  }
  return pixels;
}

std::string picture_tag(const Image& image, int zoom, const std::string& caption) {
  return tag(encode_png(image, 0), image.width, image.height, zoom, caption);
}

}  // namespace mica::host
