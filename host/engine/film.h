#pragma once

#include <string>
#include <vector>

#include "host/image/image.h"
#include "host/scene/scene.h"

namespace mica {

/// Collects traced rows and their densities into the channels of a plan.
class Film {
 public:
  Film(int width, int height, const std::vector<std::string>& channels);

  /// Adds a block of rows; `densities` in the order of its queries. Sums run in that order, in double
  /// precision.
  void add(const TracedRows& rows, const std::vector<float>& densities);

  Image take() { return std::move(image_); }

 private:
  float* channel(const std::string& name, std::size_t pixel);

  Image image_;
};

}  // namespace mica
