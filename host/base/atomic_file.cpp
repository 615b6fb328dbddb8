#include "host/base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "host/base/leftovers.h"
#include "mica/error.h"

namespace mica::host {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const char* action, int error) {
  throw FileError(fmt::format("{}: cannot {}: {}", path, action, std::strerror(error)));
}

/// What a link names, also when it is not there; the path itself when it is no link.
std::string link_target(const std::string& path) {
  constexpr int most_links = 40;  // as Linux follows
  fs::path target = path;
  std::error_code error;
  for (int n = 0; n < most_links && fs::is_symlink(fs::symlink_status(target, error)); ++n)
    target = target.parent_path() / fs::read_symlink(target, error);  // an absolute one replaces all
  return target.string();
}

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

/// Makes the rename itself durable. A folder that cannot be opened for this is no reason to fail: the file is
/// there.
void sync_folder(const std::string& path) {
  const int descriptor = open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

/// Why what is there cannot be replaced.
std::string replacing_problem(const struct stat& status) {
  // A rename would replace a device such as /dev/null by a plain file.
  if (!S_ISREG(status.st_mode)) return "cannot write: exists and is not a regular file";
  if ((status.st_mode & 0222) == 0) return "cannot write: is read-only";
  return {};
}

}  // namespace

/// A file next to its target that vanishes unless it is moved onto it.
class AtomicFile::Temporary {
 public:
  explicit Temporary(const std::string& target) : target_(target) {
    do {
      if (leftover_) leftover_->keep();  // it is someone else's
      name_ = temporary_name(target, attempt_++);
      leftover_.emplace(name_);  // before it is there: this may take memory that is not
      descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) fail(target_, "create", errno);
  }
  ~Temporary() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  void set_mode(mode_t mode) const {
    if (fchmod(descriptor_, mode & 07777) != 0) fail(target_, "write", errno);
  }

  void write(const char* bytes, std::size_t count) {
    for (std::size_t done = 0; done < count;) {
      const ssize_t written = ::write(descriptor_, bytes + done, count - done);
      if (written < 0 && errno != EINTR) fail(target_, "write", errno);
      if (written > 0) done += static_cast<std::size_t>(written);
    }
  }

  void write_at(std::size_t offset, const char* bytes, std::size_t count) {
    for (std::size_t done = 0; done < count;) {
      const ssize_t written =
          pwrite(descriptor_, bytes + done, count - done, static_cast<off_t>(offset + done));
      if (written < 0 && errno != EINTR) fail(target_, "write", errno);
      if (written > 0) done += static_cast<std::size_t>(written);
    }
  }

  void move_onto_target() {
    if (fsync(descriptor_) != 0) fail(target_, "write", errno);
    const int closed = close(std::exchange(descriptor_, -1));
    if (closed != 0) fail(target_, "write", errno);
    if (std::rename(name_.c_str(), target_.c_str()) != 0) fail(target_, "write", errno);
    leftover_->keep();
    sync_folder(target_);
  }

 private:
  std::string target_, name_;
  int attempt_ = 0;
  int descriptor_ = -1;
  std::optional<Leftover> leftover_;
};

AtomicFile::AtomicFile(const std::string& path) {
  struct stat status;
  const bool exists = stat(path.c_str(), &status) == 0;
  if (exists)
    if (const std::string problem = replacing_problem(status); !problem.empty())
      throw FileError(path + ": " + problem);
  file_ = std::make_unique<Temporary>(link_target(path));
  if (exists) file_->set_mode(status.st_mode);
}

AtomicFile::~AtomicFile() = default;

void AtomicFile::append(const void* bytes, std::size_t count) {
  file_->write(static_cast<const char*>(bytes), count);
}

void AtomicFile::write_at(std::size_t offset, const void* bytes, std::size_t count) {
  file_->write_at(offset, static_cast<const char*>(bytes), count);
}

void AtomicFile::finish() {
  file_->move_onto_target();
}

void write_file_atomically(const std::string& path, const std::string& bytes) {
  AtomicFile file(path);
  file.append(bytes);
  file.finish();
}

std::string writing_problem(const std::string& path) {
  struct stat status;
  if (stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) return "is a folder, expected a file to write";
    if (std::string problem = replacing_problem(status); !problem.empty()) return problem;
  } else if (errno != ENOENT) {
    return fmt::format("cannot write: {}", std::strerror(errno));
  }
  fs::path folder = folder_of(link_target(path));
  while (stat(folder.c_str(), &status) != 0) {  // the nearest that is there is what others are made in
    if (errno != ENOENT) return fmt::format("cannot write into its folder: {}", std::strerror(errno));
    folder = folder_of(folder.string());
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    return fmt::format("cannot write into its folder: {}", std::strerror(errno));
  return {};
}

}  // namespace mica::host
