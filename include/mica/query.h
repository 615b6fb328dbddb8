#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "mica/span.h"
#include "mica/version.h"

MICA_BEGIN_NAMESPACE

/// How the half vector turns over a footprint: d(s, t) / d(u, v), per unit of uv.
struct HalfVectorTurn {
  double su = 0, sv = 0, tu = 0, tv = 0;
};

/// Covariance of the lobe on the disk, in place of roughness^2 on the diagonal.
struct LobeCovariance {
  double rss = 0, rst = 0, rtt = 0;
};

/// One question: the density of normals D(s, t) over the unit disk, under a Gaussian footprint of texture
/// space. [Yan14] Eq. 6. Plain numbers, in the order of the command line's table.
struct Query {
  double u = 0, v = 0;               ///< mean of the footprint; one period of the map is [0, 1)^2
  double cuu = 1, cuv = 0, cvv = 1;  ///< its covariance, uv^2; positive definite
  double s = 0, t = 0;               ///< half vector on the disk
  double roughness = 0.01;           ///< standard deviation of the intrinsic Gaussian on the disk, 1e-5 to 1
  HalfVectorTurn turn = {};          ///< zero: the half vector is the same all over the footprint
  LobeCovariance lobe = {};          ///< all zero: roughness^2 along both axes
};

/// One number a query, in the caller's memory: of float or double, any distance apart; or one number for all.
class Column {
 public:
  Column(double value = 0) : value_(value) {}  // NOLINT(google-explicit-constructor)
  /// @param stride numbers from one query's to the next one's.
  explicit Column(const double* data, std::ptrdiff_t stride = 1)
      : kind_(Kind::doubles), data_(data), stride_(stride) {}
  explicit Column(const float* data, std::ptrdiff_t stride = 1)
      : kind_(Kind::floats), data_(data), stride_(stride) {}

  double operator[](std::size_t n) const {
    const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(n) * stride_;
    if (kind_ == Kind::doubles) return static_cast<const double*>(data_)[place];
    return kind_ == Kind::floats ? static_cast<double>(static_cast<const float*>(data_)[place]) : value_;
  }
  bool is_null() const { return kind_ != Kind::constant && data_ == nullptr; }

 private:
  enum class Kind { constant, doubles, floats };
  Kind kind_ = Kind::constant;
  double value_ = 0;
  const void* data_ = nullptr;
  std::ptrdiff_t stride_ = 1;
};

/// Gaussian footprints: a view of the caller's memory, which is read in place.
struct Footprints {
  std::size_t count = 0;
  Column u, v, cuu = 1.0, cuv, cvv = 1.0;
};

/// Questions for densities; a view of the caller's memory, which is read in place. What is not set is one
/// number for all.
struct MICA_API Queries : Footprints {
  Column s, t, roughness = 0.01;
  Column su, sv, tu, tv;  ///< turn of the half vector
  Column rss, rst, rtt;   ///< covariance of the lobe; used where has_lobe
  bool has_turn = false, has_lobe = false;

  Queries() = default;
  Queries(Span<const Query> queries);  // NOLINT(google-explicit-constructor)
  Queries(const std::vector<Query>& queries)
      : Queries(Span<const Query>(queries)) {}  // NOLINT(google-explicit-constructor)
  /// Rows u v cuu cuv cvv s t [roughness], or u v cuu cuv cvv s t rss rst rtt su sv tu tv.
  /// @param columns 7, 8 or 14. Throws UsageError for another number.
  static Queries of_rows(const double* rows, std::size_t count, int columns, double roughness = 0.01);
  static Queries of_rows(const float* rows, std::size_t count, int columns, double roughness = 0.01);

  Query operator[](std::size_t n) const;
};

/// Questions for all light that footprints scatter to views: directions o towards the eye in the map's
/// tangent frame, z along the geometric normal; of any length but 0.
struct Views : Footprints {
  Column ox, oy, oz = 1.0, roughness = 0.01;
};

/// Questions for BRDFs: views, and directions i towards the light.
struct Lightings : Views {
  Column ix, iy, iz = 1.0;
};

MICA_END_NAMESPACE
