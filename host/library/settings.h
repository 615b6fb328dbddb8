#pragma once

#include <memory>
#include <string>

#include "host/methods/registry.h"
#include "host/surface/description.h"
#include "mica/settings.h"

namespace mica::host {

/// A method's settings from those of a caller. Throws UsageError for keys that the method does not know.
std::unique_ptr<MethodSettings> method_settings(const Method& method, const Settings& settings);

/// "uv" of query 7 and so on: throws UsageError with `problem` when there is one.
void refuse_query(std::size_t number, const std::string& problem);

}  // namespace mica::host
