#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "host/base/glints.h"
#include "host/base/query.h"
#include "host/methods/choice.h"
#include "host/methods/map/image_window.h"

namespace mica::host {

/// Densities that a device is computing.
class PendingDensities {
 public:
  virtual ~PendingDensities() = default;
  /// Waits; D of every query, in the order they were given, finite and >= 0. Call once. Throws DeviceError.
  virtual std::vector<float> wait() = 0;
  /// What glints of one colour add to D of a query, where they have several. Call after `wait`.
  virtual float density_of_color(std::size_t /*color*/, std::size_t /*query*/) const { return 0; }
};

/// Draws images of P-NDFs by a way of its own, faster than query by query.
class Painter {
 public:
  virtual ~Painter() = default;
  /// One image a query, whose half vector does not matter; 0 off the disk.
  virtual std::vector<float> paint(const std::vector<Query>& footprints, const ImageWindow& window) = 0;
};

/// The queries of a job or a table, by their number.
using QuerySource = std::function<Query(std::size_t)>;

/// Evaluates the P-NDF of one surface in batches. A query's result depends on the query alone: not on the
/// batch it is in, its place there, or the number of threads.
class Evaluator {
 public:
  virtual ~Evaluator() = default;

  /// Sends queries to the device and returns; the queries are copied. All must pass the method's
  /// `query_problem`.
  virtual std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) = 0;
  /// The same where glints differ from query to query. @param points what they are at each.
  virtual std::unique_ptr<PendingDensities> start_at(const std::vector<Query>& queries,
                                                     const std::vector<GlintPoint>& /*points*/) {
    return start(queries);
  }

  std::vector<float> evaluate(const std::vector<Query>& queries) { return start(queries)->wait(); }

  /// For methods that choose among others: looks at queries 0 .. count - 1, each of which stands for `scale`
  /// ones of the job. Others need not look.
  virtual void calibrate(std::size_t /*count*/, const QuerySource&, double /*scale*/) {}
  virtual std::vector<AutoChoice> choices() const { return {}; }

  /// A way to draw images of footprints 0 .. count - 1, or null: then each pixel is a query.
  virtual std::unique_ptr<Painter> painter(std::size_t /*count*/, const QuerySource& /*footprint*/,
                                           const ImageWindow&) {
    return nullptr;
  }

  /// How far `density`, the answer to a query, may be off; of methods that say so (MethodTraits).
  virtual double error_estimate(const Query&, double /*density*/) const {
    return std::numeric_limits<double>::infinity();
  }

  /// Answers so far that were not finite, and were replaced by the oracle's; see with_finite_answers.
  virtual std::size_t replaced() const { return 0; }

  virtual std::string name() const = 0;
  virtual std::size_t device_bytes() const = 0;  ///< of its structures, without batches
  virtual double build_seconds() const = 0;      ///< that its structures took on the host
  virtual double device_seconds() const = 0;     ///< that its kernels ran so far, by the device's own clock
};

}  // namespace mica::host
