#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/image/image.h"
#include "host/scene/scene.h"

namespace mica::host {

/// The light of traced pixels; `densities` in the order of their queries, in which they are summed, in double
/// precision.
std::vector<Eigen::Vector3d> radiance_of(const TracedRows& rows, const std::vector<float>& densities);

/// Collects traced rows and their densities into the channels of a plan.
class Film {
 public:
  Film(int width, int height, const std::vector<std::string>& channels);

  /// Adds a block of rows; `densities` in the order of its queries.
  /// @param errors estimates of the densities'; empty: there is no channel for them.
  void add(const TracedRows& rows, const std::vector<float>& densities,
           const std::vector<float>& errors = {});

  Image take() { return std::move(image_); }

 private:
  /// Calls `write_pixel` for pixels from `first_pixel` on, with where a channel and those after it are;
  /// unless the image does not have it.
  void write(std::size_t first_pixel, const std::string& first_channel, std::size_t pixels,
             const std::function<void(std::size_t pixel, float* out)>& write_pixel);

  Image image_;
};

}  // namespace mica::host
