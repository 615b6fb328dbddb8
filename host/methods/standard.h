#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "host/base/constants.h"
#include "host/base/query.h"

namespace mica::host {

/// Share of a footprint's peak that answers may be off by, whatever else they promise.
constexpr double kPeakBound = 1e-6;

/// What `triangles` keeps of the map's density, relative.
inline double relative_bound(double roughness) {
  return roughness < 1e-3 ? 1e-3 : 1e-4;
}

/// What a method promises: |D - ref| <= relative * ref + of_peak * peak, where peak is the largest reference
/// of the footprint over its half vectors.
struct Promise {
  double relative = 1e-4, of_peak = kPeakBound;
};

/// The peak of a query's intrinsic Gaussian.
inline double lobe_peak(const Query& query) {
  return 1 / (2 * kPi * query.roughness * query.roughness);
}

/// What the answers of a method on one surface are held to: its own definition in double precision.
class Standard {
 public:
  virtual ~Standard() = default;

  virtual std::vector<double> references(const std::vector<Query>& queries) const = 0;
  virtual Promise promise(double roughness) const = 0;
  /// Whether the definition is the map's own density. A mixture's is its sum, and is asked for the map
  /// besides.
  virtual bool is_the_map() const { return false; }
  /// Highest density that can be right.
  virtual double highest(const Query&) const { return std::numeric_limits<float>::max(); }
  /// Why more than what is allowed is no mistake, or empty. @param probes each of one footprint.
  virtual std::string limitation(const std::vector<std::vector<Query>>& /*probes*/, const Query& /*worst*/,
                                 double /*worst_error*/) const {
    return "";
  }
  /// How far a density is off, in units of what is allowed.
  virtual double error(const Query& query, double density, double reference, double peak) const {
    const Promise allowed = promise(query.roughness);
    const double difference = std::abs(density - reference);
    return difference == 0 ? 0 : difference / (allowed.relative * reference + allowed.of_peak * peak);
  }
};

}  // namespace mica::host
