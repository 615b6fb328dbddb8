// Pictures inside a page: PNG files as data URLs.
#pragma once

#include <string>
#include <vector>

#include "host/image/image.h"

namespace mica::host {

/// RFC 4648.
std::string base64(const std::string& bytes);

/// An <img> of side x side values, enlarged `zoom` times without blur.
std::string image_tag(int width, int height, const std::vector<std::uint8_t>& srgb, int zoom,
                      const std::string& caption);

/// Values from 0 to `white` as grey, with the square root of their share: faint parts stay visible.
std::vector<std::uint8_t> grey_pixels(const std::vector<float>& values, double white);

/// Differences from -limit (blue) over 0 (white) to limit (orange): told apart by colour-blind eyes.
std::vector<std::uint8_t> difference_pixels(const std::vector<float>& values,
                                            const std::vector<float>& reference, double limit);

/// A rendering as its preview shows it.
std::string picture_tag(const Image& image, int zoom, const std::string& caption);

}  // namespace mica::host
