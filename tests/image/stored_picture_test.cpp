// Pictures that Mica wrote, read back: whole, or refused.
#include "host/image/stored_picture.h"

#include "host/image/image.h"
#include "tests/image/folder.h"

namespace mica::host::stored_picture_test {
namespace {

class StoredPicture : public FolderTest {
 protected:
  static Image picture() {
    Image image;
    image.width = 5, image.height = 4, image.channels = {"R", "G", "B", "ndf.Y"};
    for (int n = 0; n < 5 * 4 * 4; ++n) image.pixels.push_back(0.013f * static_cast<float>(n * n % 71));
    image.metadata = {{"mica:job", "00ff17"}, {"mica:frame", "3"}};
    return image;
  }
  void write(const std::string& file, const std::string& content) const {
    std::ofstream(path(file), std::ios::binary) << content;
  }
};

TEST_F(StoredPicture, IsWhatWasWritten) {
  Image image = picture();
  image.first_row = 7, image.whole_height = 20;
  write_exr(path("a.exr"), image);
  const Image found = read_stored_picture(path("a.exr"));
  EXPECT_EQ(found.pixels, image.pixels);
  EXPECT_EQ(found.channels, image.channels);
  EXPECT_EQ(found.metadata, image.metadata);
  EXPECT_EQ(found.width, 5);
  EXPECT_EQ(found.height, 4);
  EXPECT_EQ(found.first_row, 7);
  EXPECT_EQ(found.whole_height, 20);
  write_png(path("a.png"), picture(), 0);
  const Image preview = read_stored_picture(path("a.png"));
  EXPECT_EQ(preview.metadata, image.metadata);
  EXPECT_EQ(preview.pixels.size(), 5u * 4u * 3u);
}

TEST_F(StoredPicture, IsRefusedUnlessItIsWhole) {
  write_exr(path("a.exr"), picture());
  write_png(path("a.png"), picture(), 0);
  for (const char* file : {"a.exr", "a.png"}) {
    const std::string good = bytes(path(file));
    for (const std::size_t length : {good.size() - 1, good.size() - 30, good.size() / 2, std::size_t{8}}) {
      write(file, good.substr(0, length));
      EXPECT_THROW(read_stored_picture(path(file)), FileError) << file << length;
    }
    write(file, good);
    EXPECT_NO_THROW(read_stored_picture(path(file)));
  }
  EXPECT_THROW(read_stored_picture(path("none.exr")), FileError);
}

// Codecs have checksums of their own where they compress; what they store as it is has the hash.
TEST_F(StoredPicture, IsRefusedWhenItsPixelsChanged) {
  Image image = picture();
  std::uint32_t state = 1;
  for (float& pixel : image.pixels) {  // noise, which is not compressed
    state = state * 1664525u + 1013904223u;
    pixel = static_cast<float>(state) * 0x1p-32f;
  }
  write_exr(path("a.exr"), image);
  const std::string good = bytes(path("a.exr"));
  for (std::size_t back = 1; back < 200; back += 7) {
    std::string changed = good;
    changed[good.size() - back] = static_cast<char>(changed[good.size() - back] ^ 1);
    write("a.exr", changed);
    EXPECT_THROW(read_stored_picture(path("a.exr")), FileError) << back;
  }
}

}  // namespace
}  // namespace mica::host::stored_picture_test
