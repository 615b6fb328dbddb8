#include "host/device/binary_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>

#include "host/base/atomic_file.h"
#include "host/base/interrupt.h"
#include "host/base/leftovers.h"
#include "host/base/stopwatch.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr double kLongestWait = 120;  // seconds, for another process that compiles

std::filesystem::path cache_folder() {
  if (const char* folder = std::getenv("MICA_CACHE_DIR"); folder && *folder) return folder;
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
bool is_trusted(const std::string& path, mode_t type) {
  struct stat status;
  return stat(path.c_str(), &status) == 0 && (status.st_mode & S_IFMT) == type &&
         status.st_uid == geteuid() && (status.st_mode & 022) == 0;
}

/// Makes the folder of `path` where it is not there. @return whether files of ours may be in it.
bool make_folder_of(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::filesystem::create_directories(folder.parent_path(), ignored);
  mkdir(folder.c_str(), 0700);
  return is_trusted(folder.string(), S_IFDIR);
}

/// Locks one byte of a file; false when another process has it. An error counts as locked: where there are no
/// locks everyone works for himself.
bool try_lock(int descriptor, off_t byte) {
  struct flock lock = {};
  lock.l_type = F_WRLCK, lock.l_whence = SEEK_SET, lock.l_start = byte, lock.l_len = 1;
  return fcntl(descriptor, F_OFD_SETLK, &lock) == 0 || (errno != EAGAIN && errno != EACCES);
}

std::optional<std::vector<unsigned char>> read_verified(const std::string& path) {
  if (path.empty() || !is_trusted(path, S_IFREG) ||
      !is_trusted(std::filesystem::path(path).parent_path().string(), S_IFDIR))
    return std::nullopt;
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
  key_ = hash.low64;
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
  if (path_.empty() || !make_folder_of(path_)) return;
  remove_stale_temporaries(std::filesystem::path(path_).parent_path().string());
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

BinaryCache::Turn::~Turn() {
  if (descriptor_ >= 0) close(descriptor_);  // and with it goes the lock, as it does with the process
}

BinaryCache::Turn BinaryCache::wait_for_turn() const {
  if (path_.empty() || !make_folder_of(path_)) return Turn(-1);
  const std::string file = (std::filesystem::path(path_).parent_path() / "lock").string();
  const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) return Turn(-1);
  const auto byte = static_cast<off_t>(key_ % (std::uint64_t{1} << 40));  // one for each program
  const Stopwatch waiting;
  std::chrono::milliseconds pause{5};
  while (!try_lock(descriptor, byte) && waiting.seconds() < kLongestWait) {
    check_interrupt();
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::milliseconds{500});
  }
  return Turn(descriptor);
}

}  // namespace mica::host
