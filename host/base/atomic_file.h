#pragma once

#include <cstddef>
#include <memory>
#include <string>

namespace mica::host {

/// A file that is written piece by piece, and appears whole or not at all: a link's target is written, beside
/// itself, and what is replaced keeps its mode. Unless it is finished nothing of it stays.
class AtomicFile {
 public:
  /// Throws FileError, as all that follows.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();

  void append(const void* bytes, std::size_t count);
  void append(const std::string& bytes) { append(bytes.data(), bytes.size()); }
  /// Bytes at a place of the file, instead of those that are there. What is appended is not moved by them.
  void write_at(std::size_t offset, const void* bytes, std::size_t count);
  /// Makes what was written durable, and the file. Call once.
  void finish();

 private:
  class Temporary;
  std::unique_ptr<Temporary> file_;
};

/// The same of a file whose bytes are at hand.
void write_file_atomically(const std::string& path, const std::string& bytes);

/// Why `path` cannot be written, empty when it seems it can: something that is no plain file, read-only, a
/// name that is too long, a folder that cannot be written into. Folders that are not there yet are no reason.
std::string writing_problem(const std::string& path);

}  // namespace mica::host
