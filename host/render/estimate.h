#pragma once

#include <cstddef>

#include "host/base/findings.h"
#include "host/device/device.h"
#include "host/job/job.h"
#include "host/render/plan.h"

namespace mica::host {

/// What rendering a job will take, found by tracing a few rows and evaluating a few of their queries.
struct Estimate {
  std::size_t queries = 0;
  double seconds = 0;            ///< wall clock, without the audit
  std::size_t device_bytes = 0;  ///< of structures and batches, at the most at a time
  Findings findings;             ///< of the surfaces and images that were read
};

/// Builds what the plan names and tries it on a sample. Throws mica::Error.
Estimate estimate(const Job& job, const Plan& plan, Device& device);

}  // namespace mica::host
