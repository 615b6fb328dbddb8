#include "host/device/binary_cache.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "host/base/atomic_file.h"
#include "host/base/leftovers.h"
#include "mica/error.h"

namespace mica::host {
namespace {

std::filesystem::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return std::filesystem::path(cache) / "mica";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::filesystem::path(home) / ".cache" / "mica";
  return {};
}

/// What stands before a binary: drivers do not survive one that is cut short or changed.
struct Seal {
  char magic[8] = {'m', 'i', 'c', 'a', 'b', 'i', 'n', '1'};
  std::uint64_t size = 0;
  XXH128_canonical_t hash{};
};

Seal seal_of(const unsigned char* bytes, std::size_t size) {
  Seal seal;
  seal.size = size;
  XXH128_canonicalFromHash(&seal.hash, XXH3_128bits(bytes, size));
  return seal;
}

std::string with_seal(const std::vector<unsigned char>& binary) {
  const Seal seal = seal_of(binary.data(), binary.size());
  std::string bytes(reinterpret_cast<const char*>(&seal), sizeof seal);
  return bytes.append(reinterpret_cast<const char*>(binary.data()), binary.size());
}

/// Code is run from here: it has to be the user's own, and nobody else's to write.
bool is_trusted(const std::string& path) {
  struct stat status;
  return stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == geteuid() &&
         (status.st_mode & 022) == 0;
}

std::optional<std::vector<unsigned char>> read_verified(const std::string& path) {
  if (path.empty() || !is_trusted(path)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  Seal found;
  if (!file.read(reinterpret_cast<char*>(&found), sizeof found)) return std::nullopt;
  std::vector<unsigned char> binary((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const Seal expected = seal_of(binary.data(), binary.size());
  if (binary.empty() || std::memcmp(&found, &expected, sizeof found) != 0) return std::nullopt;
  return binary;
}

}  // namespace

BinaryCache::BinaryCache(const DeviceInfo& info, const std::string& source, const std::string& options)
    : options_(options) {
  const std::filesystem::path folder = cache_folder();
  if (folder.empty()) return;
  const std::string key = fmt::format("{}\n{}\n{}\n{}\n{}\n{}", info.platform, info.name, info.version,
                                      info.driver, options, source);
  const XXH128_hash_t hash = XXH3_128bits(key.data(), key.size());
  path_ = (folder / fmt::format("{:016x}{:016x}.bin", hash.high64, hash.low64)).string();
}

bool BinaryCache::load(const cl::Context& context, const cl::Device& device, cl::Program* program) const {
  const std::optional<std::vector<unsigned char>> binary = read_verified(path_);
  if (!binary) return false;
  try {
    *program = cl::Program(context, {device}, {*binary});
    program->build({device}, options_.c_str());
    return true;
  } catch (const cl::Error&) {
    return false;  // of a driver that changed without saying so
  }
}

void BinaryCache::store(const cl::Program& program) const {
  if (path_.empty()) return;
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
  std::filesystem::create_directories(folder.parent_path(), ignored);
  mkdir(folder.c_str(), 0700);
  remove_stale_temporaries(folder.string());
  try {
    const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
    write_file_atomically(path_, with_seal(binaries.at(0)));
    chmod(path_.c_str(), 0600);
  } catch (const cl::Error&) {
    // a driver without binaries
  } catch (const Error&) {
    // a cache that cannot be written is none
  }
}

}  // namespace mica::host
