#pragma once

#include <vector>

#include "host/base/words.h"

namespace mica::host {

enum class FilterKind { subpixels, gaussian, blackman_harris, box };

template <>
struct Words<FilterKind> {
  static constexpr Word<FilterKind> all[] = {{"subpixels", FilterKind::subpixels},
                                             {"gaussian", FilterKind::gaussian},
                                             {"blackman-harris", FilterKind::blackman_harris},
                                             {"box", FilterKind::box}};
};

/// How a pixel weighs the light about its centre: a product of the same function along both axes.
struct FilterDescription {
  FilterKind kind = FilterKind::subpixels;
  /// Standard deviation of `gaussian`, whole width of `blackman_harris` and `box`, in pixels; 0 stands for
  /// 0.5, 1.5 and 1. `subpixels`, a Gaussian of half a subpixel in each of them, has none.
  double width = 0;
};

/// Gaussians at equal distances along an axis, whose weighted sum stands for a filter.
struct FilterSum {
  double sigma_pixels = 0;             ///< of each
  std::vector<double> offsets_pixels;  ///< from the pixel's centre, ascending
  std::vector<double> weights;         ///< not negative; they add up to 1
  double relative_l2 = 0;              ///< of the sum against the filter, along the axis

  double variance() const;  ///< along an axis, pixels^2
};

/// A pixel's filter.
class PixelFilter {
 public:
  /// Throws UsageError for a width that is not finite and positive.
  explicit PixelFilter(const FilterDescription& description);

  /// The same filter for a reference on finer lattices: less is cut off, and the Gaussians overlap more.
  /// @param subpixels a pixel that define FilterKind::subpixels; the other kinds do not depend on them.
  PixelFilter for_reference(int subpixels) const;

  /// The same filter for images that were sampled by somebody else on one lattice, all of which is summed:
  /// less of a Gaussian is cut off, and a box is widened less.
  PixelFilter for_layer() const;

  /// Along one axis, its integral being 1; of `subpixels` with 4 of them, if not for a reference with others.
  double density(double offset_pixels) const;
  /// Light from further away along an axis has no weight, or less than 0.3% in all; 0.01% for a reference
  /// or a layer.
  double reach_pixels() const;
  /// Pixels beyond a pixel whose light it sees, along an axis.
  int margin_pixels() const;

  /// By Gaussians of `subpixels` a pixel in all pixels within its reach: those at the centres of subpixels,
  /// from the first one of the first pixel to the last of the last.
  FilterSum on_lattice(int subpixels) const;
  /// By as few Gaussians as are worth having.
  FilterSum by_few() const;

 private:
  FilterSum whole_lattice(int subpixels) const;

  FilterDescription description_;
  int reference_subpixels_ = 0;  // for a reference: that define the kind of that name; else 0
  bool is_for_layer_ = false;
};

/// The sum of `count` Gaussians of `sigma`, `spacing` apart, nearest to `density` in the mean square, with
/// weights that are not negative.
/// @param density vanishes beyond +-`reach`.
FilterSum fit_gaussians(double (*density)(double x, double width), double width, double reach, double sigma,
                        std::size_t count, double spacing);

/// A Gaussian of unit variance as a sum of `count` narrower ones, for splits that leave 0.7% at most.
struct GaussianSplit {
  double sigma;  ///< of each part
  FilterSum parts;
};
/// By falling sigma.
const std::vector<GaussianSplit>& gaussian_splits();

}  // namespace mica::host
