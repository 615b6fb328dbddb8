#include "host/scene/obj_lines.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "mica/error.h"

namespace mica::host {
namespace {

constexpr std::size_t kLongestLine = 16 << 20;  // a polygon of half a million corners
constexpr int kEnd = -1;

}  // namespace

ObjLines::ObjLines(const std::string& path) : path_(path), block_(1 << 16) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw FileError(fmt::format("{}: cannot read: {}", path, error ? error.message() : "not a regular file"));
  stream_.open(path, std::ios::binary);
  if (!stream_) throw FileError(fmt::format("{}: cannot read: {}", path, std::strerror(errno)));
  if (peek() == '\x1f') throw FileError(fmt::format("{}: is compressed (gzip), expected OBJ text", path));
  if (peek() == 0xef && end_ >= 3 && block_[1] == '\xbb' && block_[2] == '\xbf') begin_ = 3;
}

int ObjLines::peek() {
  if (begin_ == end_) {
    stream_.read(block_.data(), static_cast<std::streamsize>(block_.size()));
    begin_ = 0, end_ = static_cast<std::size_t>(stream_.gcount());
    if (stream_.bad()) throw FileError(fmt::format("{}: cannot read: {}", path_, std::strerror(errno)));
  }
  return begin_ == end_ ? kEnd : static_cast<unsigned char>(block_[begin_]);
}

int ObjLines::get() {
  const int c = peek();
  if (c != kEnd) ++begin_;
  return c;
}

bool ObjLines::next(std::string* line) {
  line->clear();
  if (peek() == kEnd) return false;
  number_ = ended_ + 1;
  for (int c = get(); c != kEnd; c = get()) {
    if (c == '\r' || c == '\n') {
      if (c == '\r' && peek() == '\n') get();
      ++ended_;
      if (line->empty() || line->back() != '\\') return true;
      line->back() = ' ';
      continue;
    }
    if (line->size() == kLongestLine)
      throw FileError(
          fmt::format("{}:{}: found a line of more than {} bytes, expected an OBJ file's statement", path_,
                      number_, kLongestLine));
    line->push_back(static_cast<char>(c));
  }
  return true;
}

}  // namespace mica::host
