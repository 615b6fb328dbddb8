#include "host/image/exr_rows.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <optional>

#include "host/base/atomic_file.h"
#include "host/image/file_errors.h"

namespace mica::host {
namespace {

/// Hands what OpenImageIO writes to an AtomicFile, and keeps the beginning, where the header is.
class AtomicProxy : public OIIO::Filesystem::IOProxy {
 public:
  explicit AtomicProxy(const std::string& path) : IOProxy("", Write), file_(path) {}

  const char* proxytype() const override { return "atomic"; }
  std::size_t write(const void* bytes, std::size_t count) override {
    const std::size_t written = pwrite(bytes, count, m_pos);
    m_pos += static_cast<std::int64_t>(written);
    return written;
  }
  std::size_t pwrite(const void* bytes, std::size_t count, std::int64_t offset) override {
    try {
      const auto at = static_cast<std::size_t>(offset);
      file_.write_at(at, bytes, count);
      keep_header(at, static_cast<const char*>(bytes), count);
      size_ = std::max(size_, at + count);
      return count;
    } catch (...) {  // past the library, which would lose its kind
      error_ = std::current_exception();
      return 0;
    }
  }
  std::size_t size() const override { return size_; }

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }
  /// Puts `text`, filled with blanks, where the header has `place`.
  void replace(const std::string& place, std::string text) {
    const std::size_t at = header_.find(place);
    text.resize(place.size(), ' ');
    if (at != std::string::npos) file_.write_at(at, text.data(), text.size());
  }
  void finish() { file_.finish(); }

 private:
  void keep_header(std::size_t at, const char* bytes, std::size_t count) {
    constexpr std::size_t most = 1 << 20;
    if (at >= most) return;
    header_.resize(std::max(header_.size(), std::min(at + count, most)));
    header_.replace(at, std::min(count, most - at), bytes, std::min(count, most - at));
  }

  AtomicFile file_;
  std::size_t size_ = 0;
  std::string header_;
  std::exception_ptr error_;
};

std::string place_of(const std::string& attribute, std::size_t letters) {
  std::string place = "(" + attribute + " is not known yet)";
  place.resize(std::max(letters, place.size()), '.');
  return place;
}

bool is_lossless(const std::string& compression) {
  for (const char* name : {"none", "rle", "zip", "zips", "piz"})
    if (compression == name) return true;
  return false;
}

}  // namespace

class ExrRows::Writer {
 public:
  Writer(const std::string& path, const FileWindow& window, const std::vector<std::string>& channels,
         const std::map<std::string, std::string>& metadata, const std::map<std::string, std::size_t>& later)
      : path_(path),
        later_(later),
        proxy_(path),
        row_floats_(static_cast<std::size_t>(window.width) * channels.size()) {
    OIIO::ImageSpec spec(window.width, window.height, static_cast<int>(channels.size()), OIIO::TypeFloat);
    spec.channelnames = channels;
    spec.x = window.left, spec.y = window.top;
    spec.full_x = spec.full_y = 0;
    spec.full_width = window.whole_width, spec.full_height = window.whole_height;
    for (const auto& [name, value] : metadata) spec.attribute(name, value);
    for (const auto& [name, letters] : later) spec.attribute(name, place_of(name, letters));
    spec.attribute("compression", is_lossless(window.compression) ? window.compression : "zip");
    spec.attribute("oiio:ColorSpace", "Linear");
    // OpenImageIO would write the time of day; the file shall depend on the image alone.
    spec.attribute("DateTime", "1970:01:01 00:00:00");
    output_ = OIIO::ImageOutput::create("openexr", &proxy_);
    if (!output_) throw FileError(path_ + ": OpenImageIO cannot write openexr: " + OIIO::geterror());
    y_ = window.top;
    check(output_->open(path_, spec));
  }

  void append(const std::vector<float>& pixels) {
    const int rows = static_cast<int>(pixels.size() / row_floats_);
    check(output_->write_scanlines(y_, y_ + rows, 0, OIIO::TypeFloat, pixels.data()));
    y_ += rows;
  }

  void finish(const std::map<std::string, std::string>& given) {
    check(output_->close());
    for (const auto& [name, letters] : later_) {
      const auto found = given.find(name);
      proxy_.replace(place_of(name, letters), found == given.end() ? "none" : found->second);
    }
    proxy_.finish();
  }

 private:
  void check(bool good) const {
    proxy_.rethrow();
    if (!good) throw FileError(fmt::format("{}: cannot encode as openexr: {}", path_, output_->geterror()));
  }

  std::string path_;
  std::map<std::string, std::size_t> later_;
  AtomicProxy proxy_;
  std::size_t row_floats_;
  int y_ = 0;
  std::unique_ptr<OIIO::ImageOutput> output_;  // goes before the proxy
};

ExrRows::ExrRows(const std::string& path, const FileWindow& window, const std::vector<std::string>& channels,
                 const std::map<std::string, std::string>& metadata,
                 const std::map<std::string, std::size_t>& later)
    : writer_(std::make_unique<Writer>(path, window, channels, metadata, later)) {}
ExrRows::~ExrRows() = default;

void ExrRows::append(const std::vector<float>& pixels) {
  writer_->append(pixels);
}
void ExrRows::finish(const std::map<std::string, std::string>& given) {
  writer_->finish(given);
}

}  // namespace mica::host
