#pragma once

#include <memory>
#include <string>

#include "host/methods/registry.h"
#include "host/surface/description.h"
#include "mica/settings.h"

namespace mica::host {

/// A method's settings from those of a caller. Throws UsageError for keys that the method does not know.
std::unique_ptr<MethodSettings> method_settings(const Method& method, const Settings& settings);

}  // namespace mica::host
