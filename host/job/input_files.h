#pragma once

#include <string>
#include <vector>

#include "host/job/job.h"

namespace mica::host {

/// Files that a surface is made of.
std::vector<std::string> input_files(const SurfaceDescription& surface);

/// The job's own file and all that it names.
std::vector<std::string> input_files(const Job& job);

/// A hash of the contents of the files that a job names, without its own; empty when it names none. Throws
/// FileError.
std::string hash_of_inputs(const Job& job);

}  // namespace mica::host
