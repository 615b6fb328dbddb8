#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/image/image.h"
#include "host/scene/scene.h"

namespace mica::host {

/// What a film could not say as a number of an image, and left black.
struct FilmRepairs {
  std::size_t not_finite = 0;  ///< light of pixels and of samples, and other channels' numbers
  std::size_t negative = 0;    ///< light of pixels
};

/// The light of samples; see radiance_of.
std::vector<Eigen::Vector3d> sample_radiance_of(const TracedRows& rows, const std::vector<float>& densities,
                                                FilmRepairs* repairs);

/// The light of traced pixels; `densities` in the order of their queries, in which they are summed, in double
/// precision. What single precision cannot say becomes black: a lamp may be as near, or a pixel as small, as
/// its numbers allow.
/// @param repairs are counted there.
std::vector<Eigen::Vector3d> radiance_of(const TracedRows& rows, const std::vector<float>& densities,
                                         FilmRepairs* repairs);

/// Estimates of pixels' errors, in luminance: of what their methods' densities may be off by, each of
/// `errors`; of what footprints and lamps' parts stand for; and of what samples leave in doubt. Sums of
/// samples count those in the pixel alone.
std::vector<double> pixel_errors(const TracedRows& rows, const std::vector<float>& densities,
                                 const std::vector<float>& errors);

/// Collects traced rows and their densities into the channels of a plan.
class Film {
 public:
  /// @param first_row of the whole picture, from which on `height` rows are collected.
  Film(int width, int height, const std::vector<std::string>& channels, int first_row = 0);

  /// Adds a block of rows; `densities` in the order of its queries.
  /// @param errors estimates of the densities'; empty: there is no channel for them.
  void add(const TracedRows& rows, const std::vector<float>& densities,
           const std::vector<float>& errors = {});

  Image take() { return std::move(image_); }
  const FilmRepairs& repairs() const { return repairs_; }

 private:
  /// Calls `write_pixel` for pixels from `first_pixel` on, with where a channel and those after it are;
  /// unless the image does not have it.
  void write(std::size_t first_pixel, const std::string& first_channel, std::size_t pixels,
             const std::function<void(std::size_t pixel, float* out)>& write_pixel);

  Image image_;
  FilmRepairs repairs_;
};

}  // namespace mica::host
