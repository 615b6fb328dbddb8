#pragma once

#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

namespace mica::host {

/// Lines of a text file whichever way they end (LF, CR LF, CR), with those joined that a backslash continues,
/// and without a byte order mark.
class ObjLines {
 public:
  /// Throws FileError: no regular file, unreadable, compressed.
  explicit ObjLines(const std::string& path);

  /// The next line; false at the end of the file. Throws FileError for one that is too long to be a
  /// statement.
  bool next(std::string* line);
  /// Of the latest line, or of the first that it was joined from.
  std::size_t number() const { return number_; }

 private:
  int get();
  int peek();

  std::string path_;
  std::ifstream stream_;
  std::vector<char> block_;
  std::size_t begin_ = 0, end_ = 0;  // of what is left of the block
  std::size_t number_ = 0, ended_ = 0;
};

}  // namespace mica::host
