#pragma once

#include <string>
#include <vector>

#include "host/measure/measure.h"
#include "host/measure/results.h"

namespace mica::host::bench {

/// Names of the suites: "tiny" takes seconds and shows that all of it works; "quick" takes less than a
/// minute, "standard" less than ten, on two idle cores.
const std::vector<std::string>& suite_names();

/// Runs a suite on the device. Throws UsageError for a name that there is not, DeviceError, and what
/// `progress` throws.
Results run_suite(const std::string& name, Device& device, const Progress& progress,
                  const MethodRegistry& methods = MethodRegistry::builtin());

}  // namespace mica::host::bench
