#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "host/base/findings.h"
#include "host/surface/description.h"

namespace mica::host {

/// A normal map on the unit disk, periodic, in texel space.
///
/// Texel (i, j), i to the right, j from the bottom, has its centre at (i + 0.5, j + 0.5) texels. Normals are
/// the projections s = (n_x, n_y), |s| < 1, in double precision: this array *is* the surface; every evaluator
/// and the oracle read the same one.
class Surface {
 public:
  /// @param normals width * height projections, row j = 0 (v near 0) first.
  /// Throws UsageError when the sizes disagree or a normal is not finite or not inside the unit disk.
  Surface(int width, int height, Interpolation interpolation, std::vector<Eigen::Vector2d> normals);

  /// What its source could tell of normals.
  struct Steps {
    double step = 0;      ///< between neighbouring values of s; 0: too fine to matter
    bool widens = false;  ///< lobes are wider by the variance of rounding
    bool halves = false;  ///< of half floats: `step` is a mean, a number's own is half_float_step
    float third = 0;  ///< between values of n_z, where all three were scaled to length 1; 0: they were not
  };
  void note_steps(const Steps& steps) { steps_ = steps; }
  double step() const { return steps_.step; }
  bool has_half_floats() const { return steps_.halves; }
  double third_step() const { return steps_.third; }
  /// What a lobe's covariance on the disk is wider by, along every axis; see Precision.
  double lobe_variance() const { return steps_.widens ? steps_.step * steps_.step / 12 : 0; }

  int width() const { return width_; }
  int height() const { return height_; }
  Interpolation interpolation() const { return interpolation_; }

  /// Normal of texel (i, j); any integers, wrapped.
  const Eigen::Vector2d& texel(long i, long j) const {
    return normals_[static_cast<std::size_t>(wrap(j, height_) * width_ + wrap(i, width_))];
  }
  const std::vector<Eigen::Vector2d>& normals() const { return normals_; }

 private:
  static long wrap(long index, long period) {
    if (0 <= index && index < period) return index;
    const long remainder = index % period;
    return remainder < 0 ? remainder + period : remainder;
  }

  int width_, height_;
  Interpolation interpolation_;
  Steps steps_;
  std::vector<Eigen::Vector2d> normals_;  ///< row j = 0 (v near 0) first
};

/// What loading or synthesising did that its user should know.
using SurfaceReport = Findings;

/// Loads or synthesises; the same description gives the same bits for any number of threads.
/// @param report filled when not null.
/// Throws FileError (unreadable, damaged, invalid texels) or UsageError (a setting out of its range, or one
/// that does not fit the file).
Surface make_surface(const SurfaceDescription& description, SurfaceReport* report);

}  // namespace mica::host
