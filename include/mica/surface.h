#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mica/settings.h"
#include "mica/span.h"
#include "mica/version.h"

namespace mica::host {
class Surface;
}

MICA_BEGIN_NAMESPACE

enum class Interpolation { nearest, bilinear, bicubic };

/// A periodic map of normals. A normal n is kept as its projection (s, t) = (n_x, n_y) on the unit disk, x
/// along +u, y along +v. Texel (i, j), j counted from the bottom, has its centre at uv ((i + 0.5) / width, (j
/// + 0.5) / height). Copies share the map.
class MICA_API NormalMap {
 public:
  /// Reads a file. @param settings the keys of a job's [surface] beside `file`: encoding, green,
  /// interpolation, invalid, height_scale. Throws FileError, and UsageError for settings that are wrong.
  static NormalMap load(const std::string& path, const Settings& settings = {});

  /// Synthesises one. @param kind "spectrum", "flakes", "scratches", "brushed" and the other words of
  /// `generate`;
  /// @param settings its keys in a job. Throws UsageError.
  static NormalMap generate(const std::string& kind, const Settings& settings = {});

  /// From normals in memory, which are copied. @param normals width * height * channels numbers, row by row
  /// from the bottom, texels from the left. @param channels 2: s, t; 3: n_x, n_y, n_z, of any length but 0.
  /// Throws UsageError for other sizes, for numbers that are not finite, and for normals that do not point
  /// up.
  static NormalMap from_normals(int width, int height, Span<const float> normals, int channels,
                                Interpolation interpolation = Interpolation::bilinear);
  static NormalMap from_normals(int width, int height, Span<const double> normals, int channels,
                                Interpolation interpolation = Interpolation::bilinear);

  int width() const;   ///< texels
  int height() const;  ///< texels
  Interpolation interpolation() const;
  /// s, t of every texel in place, in the order of from_normals: 2 * width * height numbers, which live as
  /// long as the map or a copy of it.
  Span<const double> normals() const;
  /// The same, copied. @param normals 2 * width * height numbers.
  void copy_normals(Span<float> normals) const;
  void copy_normals(Span<double> normals) const;
  /// What was assumed when it was read, and what that cost.
  const std::vector<std::string>& notes() const { return notes_; }

  /// For the library itself.
  explicit NormalMap(std::shared_ptr<const host::Surface> surface, std::vector<std::string> notes = {});
  /// Throws UsageError when this was moved from.
  const std::shared_ptr<const host::Surface>& implementation() const;

 private:
  std::shared_ptr<const host::Surface> implementation_;
  std::vector<std::string> notes_;
};

MICA_END_NAMESPACE
