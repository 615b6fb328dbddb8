#include "host/image/channel_file.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "host/image/file_errors.h"
#include "host/image/image_header.h"

namespace mica::host {
namespace {

constexpr int kMostParts = 1000;

/// The channel's name, with the part's before it where it does not say it itself.
std::string full_name(const std::string& part, const std::string& channel) {
  const bool says_it = part.empty() || channel.compare(0, part.size() + 1, part + ".") == 0;
  return says_it ? channel : part + "." + channel;
}

}  // namespace

class ChannelFile::Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {
    const ImageFileFormat format = identify_image(path);
    if (format.reader != "openexr") fail("is " + format.reader + ", expected an OpenEXR file");
    // Rows are read a few at a time, so that the size of the whole is no limit.
    check_exr_headers(path, format, PictureUse::color, std::numeric_limits<std::uint64_t>::max());
    input_ = OIIO::ImageInput::create(format.reader);
    if (!input_ || !input_->open(path, first_)) fail(reason(input_ ? input_->geterror() : OIIO::geterror()));
    find_channels();
  }

  std::vector<float> read(int first_row, int row_count, const std::vector<int>& wanted) {
    const auto pixels = static_cast<std::size_t>(row_count) * static_cast<std::size_t>(window.width);
    std::vector<float> all(pixels * wanted.size());
    std::set<int> parts;
    for (const int n : wanted) parts.insert(channels[static_cast<std::size_t>(n)].part);
    for (const int part : parts) read_part(part, first_row, row_count, wanted, &all);
    return all;
  }

  std::map<std::string, std::string> metadata() const {
    std::map<std::string, std::string> texts;
    for (const OIIO::ParamValue& attribute : first_.extra_attribs)
      if (attribute.type() == OIIO::TypeString) texts[attribute.name().string()] = attribute.get_string();
    return texts;
  }

  const std::string& path() const { return path_; }

  FileWindow window;
  std::vector<FileChannel> channels;

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw FileError(path_ + ": cannot read: " + message);
  }

  void find_channels() {
    for (int part = 0; part < kMostParts && input_->seek_subimage(part, 0); ++part) {
      const OIIO::ImageSpec spec = input_->spec();
      if (spec.deep || spec.depth > 1) fail("holds volume or deep pixels, expected flat images");
      const FileWindow here{spec.width,
                            spec.height,
                            spec.x - spec.full_x,
                            spec.y - spec.full_y,
                            spec.full_width,
                            spec.full_height,
                            spec.get_string_attribute("compression", "none")};
      if (part == 0) window = here;
      if (here.width != window.width || here.height != window.height || here.left != window.left ||
          here.top != window.top)
        fail(fmt::format("part {} has {} x {} pixels, the first one {} x {}; expected parts of one size",
                         part, here.width, here.height, window.width, window.height));
      const std::string name = spec.get_string_attribute("oiio:subimagename");
      for (int n = 0; n < spec.nchannels; ++n)
        channels.push_back({full_name(name, spec.channelnames[static_cast<std::size_t>(n)]), part, n,
                            spec.channelformat(n) == OIIO::TypeFloat});
    }
    input_->geterror();  // that there are no more parts
  }

  void read_part(int part, int first_row, int row_count, const std::vector<int>& wanted,
                 std::vector<float>* all) {
    int first = std::numeric_limits<int>::max(), last = 0;  // one pass: lines are decompressed whole
    for (const int n : wanted) {
      const FileChannel& channel = channels[static_cast<std::size_t>(n)];
      if (channel.part == part) first = std::min(first, channel.index), last = std::max(last, channel.index);
    }
    const std::vector<float> some = read_range(part, first_row, row_count, first, last + 1);
    const auto stride = static_cast<std::size_t>(last + 1 - first);
    const std::size_t pixels = some.size() / stride;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const FileChannel& channel = channels[static_cast<std::size_t>(wanted[k])];
      if (channel.part != part) continue;
      const float* from = some.data() + (channel.index - first);
      for (std::size_t n = 0; n < pixels; ++n) (*all)[n * wanted.size() + k] = from[n * stride];
    }
  }

  /// Channels [first, end) of a part, interleaved. Tiles are read whole, and cut.
  std::vector<float> read_range(int part, int first_row, int row_count, int first, int end) {
    if (!input_->seek_subimage(part, 0)) fail(reason(input_->geterror()));
    const OIIO::ImageSpec spec = input_->spec();
    const int tile = spec.tile_height;
    const int begin = tile > 0 ? first_row / tile * tile : first_row;
    const int stop = tile > 0 ? std::min((first_row + row_count + tile - 1) / tile * tile, spec.height)
                              : first_row + row_count;
    const auto row = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(end - first);
    std::vector<float> pixels(static_cast<std::size_t>(stop - begin) * row);
    const int y = spec.y + begin, y_end = spec.y + stop;
    const bool good =
        tile > 0 ? input_->read_tiles(part, 0, spec.x, spec.x + spec.width, y, y_end, 0, 1, first, end,
                                      OIIO::TypeFloat, pixels.data())
                 : input_->read_scanlines(part, 0, y, y_end, 0, first, end, OIIO::TypeFloat, pixels.data());
    if (!good) fail(reason(input_->geterror()));
    pixels.erase(pixels.begin(), pixels.begin() + static_cast<std::ptrdiff_t>(
                                                      static_cast<std::size_t>(first_row - begin) * row));
    pixels.resize(static_cast<std::size_t>(row_count) * row);
    return pixels;
  }

  std::string path_;
  std::unique_ptr<OIIO::ImageInput> input_;
  OIIO::ImageSpec first_;
};

ChannelFile::ChannelFile(const std::string& path)
    : reader_(with_file_errors(path, [&] { return std::make_unique<Reader>(path); })) {}
ChannelFile::~ChannelFile() = default;

const std::string& ChannelFile::path() const {
  return reader_->path();
}
const FileWindow& ChannelFile::window() const {
  return reader_->window;
}
const std::vector<FileChannel>& ChannelFile::channels() const {
  return reader_->channels;
}
std::map<std::string, std::string> ChannelFile::metadata() const {
  return reader_->metadata();
}
std::vector<float> ChannelFile::read(int first_row, int row_count, const std::vector<int>& wanted) {
  return with_file_errors(path(), [&] { return reader_->read(first_row, row_count, wanted); });
}

}  // namespace mica::host
