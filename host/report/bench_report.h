#pragma once

#include <string>

#include "host/measure/results.h"

namespace mica::host {

/// Everything that was measured, as JSON text; pictures by their numbers only.
std::string bench_json(const bench::Results& results);

/// A page that explains what was measured and shows it: one file, which needs no network.
std::string bench_page(const bench::Results& results);

/// The speed and error of every measurement, a line each.
std::string bench_summary(const bench::Results& results);

}  // namespace mica::host
