#include "host/device/binary_cache.h"

#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace mica::host {
namespace {

std::filesystem::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return std::filesystem::path(cache) / "mica";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::filesystem::path(home) / ".cache" / "mica";
  return {};
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
  std::ifstream file(path_, std::ios::binary);
  if (!file) return false;
  std::vector<unsigned char> binary((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (binary.empty()) return false;
  try {
    *program = cl::Program(context, {device}, {binary});
    program->build({device}, options_.c_str());
    return true;
  } catch (const cl::Error&) {
    return false;  // damaged, or of a driver that changed without saying so
  }
}

void BinaryCache::store(const cl::Program& program) const {
  if (path_.empty()) return;
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(path_).parent_path(), ignored);
  const std::string temporary = fmt::format("{}.{}", path_, getpid());
  try {
    const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
    std::ofstream file(temporary, std::ios::binary);
    file.write(reinterpret_cast<const char*>(binaries.at(0).data()),
               static_cast<std::streamsize>(binaries[0].size()));
    file.close();
    if (file) std::filesystem::rename(temporary, path_, ignored);
  } catch (const cl::Error&) {
    // a driver without binaries
  }
  std::filesystem::remove(temporary, ignored);
}

}  // namespace mica::host
