// The .npy format: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "host/tables/table.h"
#include "mica/error.h"

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);

namespace mica::host {
namespace {

constexpr char kMagic[] = "\x93NUMPY";
constexpr std::size_t kMagicSize = 6;
constexpr std::size_t kMaxHeader = 1 << 16;  // bytes; NumPy itself refuses more than 10,000

[[noreturn]] void fail_damaged(const std::string& path, const std::string& what) {
  throw FileError(fmt::format("{}: damaged .npy file: {}", path, what));
}

[[noreturn]] void fail_unsupported(const std::string& path, const std::string& what) {
  throw UsageError(
      fmt::format("{}: {}; expected a float32 or float64 array of shape (rows, columns)", path, what));
}

struct Header {
  std::string type;  // "<f8"
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
};

/// Reads the header's text: a Python dictionary, as far as NumPy writes it.
class HeaderParser {
 public:
  HeaderParser(const std::string& path, const std::string& text) : path_(path), text_(text) {}

  Header parse() {
    Header header;
    bool has_type = false, has_order = false, has_shape = false;
    expect('{');
    while (!take('}')) {
      const std::string key = quoted();
      expect(':');
      if (key == "descr") {
        header.type = type(), has_type = true;
      } else if (key == "fortran_order") {
        header.fortran_order = boolean(), has_order = true;
      } else if (key == "shape") {
        header.shape = tuple(), has_shape = true;
      } else {
        fail_damaged(path_, fmt::format("its header has the unknown key \"{}\"", key));
      }
      if (!take(',') && peek() != '}') fail();
    }
    if (!has_type || !has_order || !has_shape)
      fail_damaged(path_, "its header lacks one of descr, fortran_order and shape");
    return header;
  }

 private:
  [[noreturn]] void fail() const {
    fail_damaged(path_, fmt::format("its header makes no sense at byte {}", position_));
  }
  char peek() {
    while (position_ < text_.size() && std::strchr(" \t\r\n", text_[position_])) ++position_;
    return position_ < text_.size() ? text_[position_] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    ++position_;
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail();
  }
  std::string quoted() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') fail();
    const std::size_t end = text_.find(quote, ++position_);
    if (end == std::string::npos) fail();
    const std::string result = text_.substr(position_, end - position_);
    position_ = end + 1;
    return result;
  }
  std::string type() {
    if (peek() == '[') fail_unsupported(path_, "holds records");
    return quoted();
  }
  bool boolean() {
    peek();
    for (const bool value : {false, true}) {
      const std::string word = value ? "True" : "False";
      if (text_.compare(position_, word.size(), word) != 0) continue;
      position_ += word.size();
      return value;
    }
    fail();
  }
  std::vector<std::uint64_t> tuple() {
    std::vector<std::uint64_t> values;
    expect('(');
    while (!take(')')) {
      peek();
      std::uint64_t value = 0;
      const char* first = text_.data() + position_;
      const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), value);
      if (error == std::errc::result_out_of_range) fail_damaged(path_, "its shape is too large");
      if (error != std::errc()) fail();
      position_ += static_cast<std::size_t>(end - first);
      take('L');  // a long of Python 2
      values.push_back(value);
      if (!take(',') && peek() != ')') fail();
    }
    return values;
  }

  const std::string& path_;
  const std::string& text_;
  std::size_t position_ = 0;
};

/// A file whose size is known, so that nothing is believed that it cannot hold.
class SizedFile {
 public:
  explicit SizedFile(const std::string& path) : path_(path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) throw FileError(path + ": no such file");
    if (!std::filesystem::is_regular_file(path, error)) throw FileError(path + ": not a regular file");
    rest_ = std::filesystem::file_size(path, error);
    if (!error) stream_.open(path, std::ios::binary);
    if (error || !stream_) throw FileError(path + ": cannot be read");
  }
  void read(void* target, std::size_t bytes, const char* what) {
    if (bytes > rest_) fail_damaged(path_, fmt::format("it ends within its {}", what));
    stream_.read(static_cast<char*>(target), static_cast<std::streamsize>(bytes));
    if (!stream_) throw FileError(path_ + ": cannot be read");
    rest_ -= bytes, data_ += static_cast<std::streamoff>(bytes);
  }
  std::uint64_t rest() const { return rest_; }

  /// Bytes from `offset` after what was read so far.
  void read_at(std::uint64_t offset, void* target, std::size_t bytes) const {
    stream_.clear();
    stream_.seekg(data_ + static_cast<std::streamoff>(offset));
    stream_.read(static_cast<char*>(target), static_cast<std::streamsize>(bytes));
    if (!stream_) throw FileError(path_ + ": cannot be read");
  }

 private:
  std::string path_;
  mutable std::ifstream stream_;  // whose place is no part of what the file is
  std::streamoff data_ = 0;       // where what was read so far ends
  std::uint64_t rest_ = 0;        // bytes not read yet
};

Header read_header(const std::string& path, SizedFile* file) {
  unsigned char start[kMagicSize + 2];
  file->read(start, sizeof start, "first eight bytes");
  if (std::memcmp(start, kMagic, kMagicSize) != 0) throw FileError(path + ": not a .npy file");
  const int version = start[kMagicSize];
  if (version < 1 || version > 3)
    throw FileError(fmt::format("{}: .npy version {} is unknown", path, version));
  std::uint32_t length = 0;
  file->read(&length, version == 1 ? 2 : 4, "header");
  if (length > kMaxHeader) fail_damaged(path, fmt::format("its header claims {} bytes", length));
  std::string text(length, '\0');
  file->read(text.data(), length, "header");
  return HeaderParser(path, text).parse();
}

/// Values of a file whose header was read.
template <typename T>
class NpyRows : public RowSource {
 public:
  /// @param swapped values are big endian.
  NpyRows(SizedFile file, const Header& header, bool swapped)
      : file_(std::move(file)),
        rows_(header.shape[0]),
        columns_(header.shape[1]),
        fortran_order_(header.fortran_order),
        swapped_(swapped) {}

  std::size_t rows() const override { return rows_; }
  std::size_t columns() const override { return columns_; }
  std::vector<double> read(std::size_t first, std::size_t count) const override {
    std::vector<double> values(count * columns_);
    if (!fortran_order_) {
      read_run(first * columns_, values.size(), [&](std::size_t n) -> double& { return values[n]; });
    } else {
      for (std::size_t column = 0; column < columns_; ++column)
        read_run(column * rows_ + first, count,
                 [&](std::size_t n) -> double& { return values[n * columns_ + column]; });
    }
    return values;
  }

 private:
  /// Values that follow each other in the file. @param place of the n-th.
  template <typename Place>
  void read_run(std::size_t first, std::size_t count, const Place& place) const {
    std::vector<T> chunk(std::min<std::size_t>(count, 1 << 16));
    for (std::size_t done = 0; done < count; done += chunk.size()) {
      const std::size_t some = std::min(chunk.size(), count - done);
      file_.read_at((first + done) * sizeof(T), chunk.data(), some * sizeof(T));
      for (std::size_t n = 0; n < some; ++n) {
        auto* const bytes = reinterpret_cast<unsigned char*>(&chunk[n]);
        if (swapped_) std::reverse(bytes, bytes + sizeof(T));
        place(done + n) = chunk[n];
      }
    }
  }

  SizedFile file_;
  std::size_t rows_, columns_;
  bool fortran_order_, swapped_;
};

}  // namespace

std::unique_ptr<RowSource> open_npy(const std::string& path) {
  SizedFile file(path);
  const Header header = read_header(path, &file);
  const bool swapped = header.type.substr(0, 1) == ">";
  const std::string kind = header.type.substr(std::min<std::size_t>(header.type.size(), 1));
  if ((header.type.substr(0, 1) != "<" && !swapped) || (kind != "f8" && kind != "f4"))
    fail_unsupported(path, fmt::format("holds values of type \"{}\"", header.type));
  if (header.shape.size() != 2)
    fail_unsupported(path, fmt::format("holds an array of {} dimensions", header.shape.size()));

  const std::uint64_t rows = header.shape[0], columns = header.shape[1];
  const std::uint64_t value_bytes = kind == "f8" ? sizeof(double) : sizeof(float);
  const std::uint64_t held = file.rest() / value_bytes;
  const bool too_many = columns != 0 && rows > held / columns;
  if (too_many || rows * columns * value_bytes != file.rest())
    fail_damaged(path, fmt::format("its header promises {} x {} values of {} bytes, but {} bytes follow",
                                   rows, columns, value_bytes, file.rest()));
  if (value_bytes == sizeof(double))
    return std::make_unique<NpyRows<double>>(std::move(file), header, swapped);
  return std::make_unique<NpyRows<float>>(std::move(file), header, swapped);
}

std::string npy_header(std::size_t rows, std::size_t columns) {
  constexpr std::size_t alignment = 64, length_size = 2;
  const std::string shape =
      columns == 0 ? fmt::format("({},)", rows) : fmt::format("({}, {})", rows, columns);
  std::string text = fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': {}, }}", shape);
  const std::size_t before = kMagicSize + 2 + length_size;
  text.append(alignment - 1 - (before + text.size()) % alignment, ' ');
  text += '\n';

  std::string bytes(kMagic, kMagicSize);
  bytes += {'\x01', '\x00', static_cast<char>(text.size() & 0xff), static_cast<char>(text.size() >> 8)};
  return bytes + text;
}

std::string to_npy(const std::vector<float>& values, std::size_t columns) {
  std::string bytes = npy_header(columns ? values.size() / columns : values.size(), columns);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  return bytes;
}

}  // namespace mica::host
