#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "host/base/query.h"

namespace mica::host {

/// Densities that a device is computing.
class PendingDensities {
 public:
  virtual ~PendingDensities() = default;
  /// Waits; D of every query, in the order they were given, finite and >= 0. Call once. Throws DeviceError.
  virtual std::vector<float> wait() = 0;
};

/// Evaluates the P-NDF of one surface in batches. A query's result depends on the query alone: not on the
/// batch it is in, its place there, or the number of threads.
class Evaluator {
 public:
  virtual ~Evaluator() = default;

  /// Sends queries to the device and returns; the queries are copied. All must pass `query_problem`.
  virtual std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) = 0;

  std::vector<float> evaluate(const std::vector<Query>& queries) { return start(queries)->wait(); }

  virtual std::string name() const = 0;
  virtual std::size_t device_bytes() const = 0;  ///< of its structures, without batches
  virtual double build_seconds() const = 0;      ///< that its structures took on the host
  virtual double device_seconds() const = 0;     ///< that its kernels ran so far, by the device's own clock
};

}  // namespace mica::host
