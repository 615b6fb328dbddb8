#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "host/image/image.h"
#include "mica/error.h"

namespace mica::host {
namespace {

[[noreturn]] void fail(const std::string& path, const char* action, int error) {
  throw FileError(fmt::format("{}: cannot {}: {}", path, action, std::strerror(error)));
}

/// A file next to its target that vanishes unless it is moved onto it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& target) : target_(target) {
    do {
      name_ = fmt::format("{}.{}-{}.tmp", target, getpid(), attempt_++);
      descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) fail(target_, "create", errno);
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!name_.empty()) unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(const std::string& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t count = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
      if (count < 0 && errno != EINTR) fail(target_, "write", errno);
      if (count > 0) done += static_cast<std::size_t>(count);
    }
    if (fsync(descriptor_) != 0) fail(target_, "write", errno);
  }

  void move_onto_target() {
    const int closed = close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) fail(target_, "write", errno);
    if (std::rename(name_.c_str(), target_.c_str()) != 0) fail(target_, "write", errno);
    name_.clear();
  }

 private:
  std::string target_, name_;
  int attempt_ = 0;
  int descriptor_ = -1;
};

/// Makes the rename itself durable. A folder that cannot be opened for this is no reason to fail: the file is
/// there.
void sync_folder(const std::string& path) {
  std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (folder.empty()) folder = ".";
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace

void write_file_atomically(const std::string& path, const std::string& bytes) {
  // A rename would replace a device such as /dev/null by a plain file.
  struct stat status;
  if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
    throw FileError(fmt::format("{}: cannot write: exists and is not a regular file", path));

  TemporaryFile file(path);
  file.write(bytes);
  file.move_onto_target();
  sync_folder(path);
}

}  // namespace mica::host
