#include "host/app/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "mica/error.h"

namespace mica::host::app {

void prepare_output(const std::string& path) {
  namespace fs = std::filesystem;
  if (fs::is_directory(path)) throw FileError(path + ": is a folder, expected a file to write");
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw FileError(fmt::format("{}: cannot make its folder: {}", path, error.message()));
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw FileError(fmt::format("{}: cannot write into its folder: {}", path, std::strerror(errno)));
}

}  // namespace mica::host::app
