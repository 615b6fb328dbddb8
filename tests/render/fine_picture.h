#pragma once

#include <algorithm>
#include <cmath>

#include "host/image/image.h"

namespace mica::host {

constexpr int kFine = 16;  // pixels a side of a fine picture in one, unless said otherwise

inline double green(const Image& image, int row, int column) {
  return static_cast<double>(
      image.pixels[(static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                    static_cast<std::size_t>(column)) *
                       image.channels.size() +
                   1]);
}

/// Of pixel (row, column) by a Gaussian of half a pixel about its centre, from a picture of single Gaussians
/// of half a fine pixel.
inline double filtered(const Image& fine, int row, int column, int side = kFine) {
  const double sigma2 = 0.25 * side * side - 0.25;
  double sum = 0, weights = 0;
  const double y = (row + 0.5) * side - 0.5, x = (column + 0.5) * side - 0.5;
  for (int j = std::max(0, static_cast<int>(y) - 5 * side / 2 - 4);
       j < std::min(fine.height, static_cast<int>(y) + 5 * side / 2 + 5); ++j)
    for (int i = std::max(0, static_cast<int>(x) - 5 * side / 2 - 4);
         i < std::min(fine.width, static_cast<int>(x) + 5 * side / 2 + 5); ++i) {
      const double weight = std::exp(-0.5 * ((j - y) * (j - y) + (i - x) * (i - x)) / sigma2);
      sum += weight * green(fine, j, i), weights += weight;
    }
  return sum / weights;
}

/// Relative L2 over the pixels whose filter lies in the picture.
inline double error(const Image& image, const Image& fine, int side = kFine) {
  double square = 0, all = 0;
  for (int row = 3; row < image.height - 3; ++row)
    for (int column = 3; column < image.width - 3; ++column) {
      const double truth = filtered(fine, row, column, side), difference = green(image, row, column) - truth;
      square += difference * difference, all += truth * truth;
    }
  return std::sqrt(square / all);
}

/// Of a channel over the same pixels.
inline double mean_of(const Image& image, std::size_t channel) {
  double sum = 0;
  for (int row = 3; row < image.height - 3; ++row)
    for (int column = 3; column < image.width - 3; ++column)
      sum += static_cast<double>(
          image.pixels[static_cast<std::size_t>(row * image.width + column) * image.channels.size() +
                       channel]);
  return sum / ((image.width - 6) * (image.height - 6));
}

}  // namespace mica::host
