#pragma once

#include <string>
#include <vector>

#include "host/job/job.h"

namespace mica::host {

/// Files that a surface is made of.
std::vector<std::string> input_files(const SurfaceDescription& surface);

/// The job's own file and all that it names.
std::vector<std::string> input_files(const Job& job);

}  // namespace mica::host
