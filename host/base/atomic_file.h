#pragma once

#include <string>

namespace mica::host {

/// Writes bytes to `path`, whole or not at all: a link's target is written, beside itself, and what is
/// replaced keeps its mode. Throws FileError.
void write_file_atomically(const std::string& path, const std::string& bytes);

/// Why `path` cannot be written, empty when it seems it can: something that is no plain file, read-only, a
/// name that is too long, a folder that cannot be written into. Folders that are not there yet are no reason.
std::string writing_problem(const std::string& path);

}  // namespace mica::host
