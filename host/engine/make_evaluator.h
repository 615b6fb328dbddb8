#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/engine/evaluator.h"
#include "host/surface/surface.h"

namespace mica {

/// Names that `make_evaluator` takes.
const std::vector<std::string>& evaluator_names();

/// The evaluator of that name on `surface`. `device` must outlive it; the surface need not.
/// Throws UsageError for a name that does not exist.
std::unique_ptr<Evaluator> make_evaluator(const std::string& name, Device& device, const Surface& surface);

}  // namespace mica
