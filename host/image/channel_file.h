#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace mica::host {

/// A channel of an EXR file, in whichever part it is.
struct FileChannel {
  std::string name;  ///< "ViewLayer.Position.X"; of a part that does not say its name in them "PART.X"
  int part = 0, index = 0;
  bool is_float = false;  ///< 32 bits; else half or whole numbers
};

/// What an EXR file says of its pixels.
struct FileWindow {
  int width = 0, height = 0;              ///< of the data window, rows from the top
  int left = 0, top = 0;                  ///< where it begins in the display window
  int whole_width = 0, whole_height = 0;  ///< of the display window
  std::string compression;
};

/// An OpenEXR file of one part or many, of which channels are read by name and rows a few at a time.
class ChannelFile {
 public:
  /// Throws FileError: no EXR file, damaged, deep, or parts of different size.
  explicit ChannelFile(const std::string& path);
  ~ChannelFile();

  const std::string& path() const;
  const FileWindow& window() const;
  const std::vector<FileChannel>& channels() const;
  std::map<std::string, std::string> metadata() const;  ///< texts of the first part's header

  /// Rows [first_row, first_row + row_count) of the data window, `wanted` interleaved, each a place in
  /// channels(). Throws FileError for pixels that cannot be read.
  std::vector<float> read(int first_row, int row_count, const std::vector<int>& wanted);

 private:
  class Reader;
  std::unique_ptr<Reader> reader_;
};

}  // namespace mica::host
