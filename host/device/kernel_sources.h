#pragma once

#include <map>
#include <string>

namespace mica::host {

/// Text of the files of kernels/, by file name; embedded at build time.
const std::map<std::string, std::string>& kernel_sources();

/// One file with its `#include "..."`s expanded, those with an include guard once, and `#line` directives
/// that keep file names and line numbers in the compiler's messages. Throws DeviceError for a name that does
/// not exist.
std::string expand_kernel_source(const std::string& name);

}  // namespace mica::host
