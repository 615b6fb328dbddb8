#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Names that `make_evaluator` takes.
const std::vector<std::string>& evaluator_names();

/// The evaluator of that name on `surface`. `device` and `surface` must outlive it.
/// @param elements of a mixture, a texel and axis; other evaluators do not mind it.
/// Throws UsageError for a name that does not exist, and for a surface or number of elements that it does not
/// take.
std::unique_ptr<Evaluator> make_evaluator(const std::string& name, Device& device, const Surface& surface,
                                          int elements = 1);

}  // namespace mica::host
