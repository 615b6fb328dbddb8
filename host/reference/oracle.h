#pragma once

#include <memory>
#include <vector>

#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host::reference {

struct OracleResult {
  double density = 0;         ///< D(s), [Yan14] Eq. 6
  double error_estimate = 0;  ///< absolute, conservative
};

/// The P-NDF in double precision on the triangulated surface, without OpenCL and without what the kernels
/// know: D(s) = integral of G_p(u) G_r(n(u) - s) du over the plane, [Yan14] Eq. 6. Triangles are visited from
/// the most to the least promising until all that remain together cannot matter.
///
/// Thread-safe; results do not depend on the number of threads.
class Oracle {
 public:
  static constexpr double default_tolerance = 1e-9;

  /// Builds bounds of the normals; keeps a reference to the surface.
  /// @param tolerance relative error aimed at, in [1e-12, 0.1]; looser is faster. Throws UsageError outside.
  explicit Oracle(const Surface& surface, double tolerance = default_tolerance);
  ~Oracle();
  Oracle(Oracle&&) noexcept;
  Oracle& operator=(Oracle&&) noexcept;

  /// Throws UsageError for a query that is not finite, a covariance that is not positive definite, a
  /// roughness that is not positive, and magnitudes beyond what doubles can answer.
  OracleResult evaluate(const Query& query) const;

  /// Many queries, in parallel; results in order. The message of a UsageError begins with the query's number,
  /// from 0.
  std::vector<OracleResult> evaluate(const std::vector<Query>& queries) const;

 private:
  class Implementation;
  std::unique_ptr<const Implementation> implementation_;
};

/// D of one query, when there is only one.
OracleResult evaluate(const Surface& surface, const Query& query);

/// D of many queries, in parallel; results in order.
std::vector<double> evaluate(const Surface& surface, const std::vector<Query>& queries);

}  // namespace mica::host::reference
