// What fuzzers share: bytes as a file, and the errors that readers are allowed.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "mica/error.h"

namespace mica::fuzz {

/// Bytes as a file of this process, in memory where the system has a place for that; removed at its end.
class File {
 public:
  explicit File(const std::string& extension) {
    const std::filesystem::path memory = "/dev/shm";
    const auto folder =
        std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
    path_ = folder / ("mica-fuzz-" + std::to_string(getpid()) + extension);
  }
  ~File() { std::filesystem::remove(path_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  const std::string& write(const std::uint8_t* bytes, std::size_t size) {
    std::FILE* const file = std::fopen(path_.c_str(), "wb");
    if (file == nullptr || std::fwrite(bytes, 1, size, file) != size || std::fclose(file) != 0) std::abort();
    return path_;
  }

 private:
  std::string path_;
};

/// Runs `read`, which may refuse what it is given; anything else that it throws is a crash.
template <typename Read>
void refusing(const Read& read) {
  try {
    read();
  } catch (const Error&) {
  }
}

}  // namespace mica::fuzz
