#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/scene/scene.h"

namespace mica::host {

/// What is known of one pixel of a block of rows once its densities are there.
struct AovPixel {
  const TracedRows& rows;
  std::size_t pixel;
  double density_sum;  ///< over the pixel's queries
  double error;        ///< estimate of that of the pixel's luminance
};

/// A channel or a few of an image that say how its light came about.
struct Aov {
  std::string word;                ///< in a job's `aovs`
  std::vector<std::string> parts;  ///< last parts of its channels' names: "uv.U", "uv.V"
  void (*write)(const AovPixel& pixel, float* parts);

  std::string channel(std::size_t part) const { return word + "." + parts[part]; }
};

/// All of them, in the order of an image's channels.
const std::vector<Aov>& aovs();

/// The channels of an image with these words: "R", "G", "B", then theirs.
std::vector<std::string> channels_of(const std::vector<std::string>& words);

}  // namespace mica::host
