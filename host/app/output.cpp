#include "host/app/output.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "host/base/atomic_file.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

namespace fs = std::filesystem;
using Identity = std::pair<dev_t, ino_t>;

/// Which file a path names, whatever links and folders lead there.
bool identify(const std::string& path, Identity* identity) {
  struct stat status;
  if (stat(path.c_str(), &status) != 0) return false;
  *identity = {status.st_dev, status.st_ino};
  return true;
}

}  // namespace

Outputs::Outputs(const std::vector<std::string>& paths, const std::vector<std::string>& inputs,
                 const std::vector<std::string>& later) {
  for (const std::string& path : paths)
    if (const std::string problem = path.empty() ? "" : writing_problem(path); !problem.empty())
      throw FileError(path + ": " + problem);
  for (const std::string& path : paths)
    if (!path.empty()) make_folder(path);
  std::vector<std::string> all = paths;
  all.insert(all.end(), later.begin(), later.end());
  check_identities(all, inputs);  // new/../map.exr names a map only now
}

void Outputs::check_identities(const std::vector<std::string>& paths,
                               const std::vector<std::string>& inputs) {
  std::map<Identity, std::string> files;
  std::set<std::string> names;
  Identity identity;
  for (const std::string& input : inputs)
    if (!input.empty() && identify(input, &identity)) files.emplace(identity, "an input, " + input + ",");
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    std::string other =
        names.insert(fs::path(path).lexically_normal().string()).second ? "" : "another output";
    if (identify(path, &identity))
      if (const auto [found, is_new] = files.emplace(identity, "another output"); !is_new)
        other = found->second;
    if (!other.empty())
      throw UsageError(
          fmt::format("{}: is to be written and is {} of the same call; expected another name", path, other));
  }
}

void Outputs::make_folder(const std::string& path) {
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  fs::path made;
  for (const fs::path& part : folder) {
    made /= part;
    std::error_code error;
    if (fs::create_directory(made, error)) folders_.emplace_front(made.string());
    if (error) throw FileError(fmt::format("{}: cannot make its folder: {}", path, error.message()));
  }
  remove_stale_temporaries(folder.string());
}

}  // namespace mica::host::app
