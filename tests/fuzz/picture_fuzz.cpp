// Headers of maps and environments: what is looked at before an image library gets to decode a file. Of the
// libraries themselves only those headers are asked that Mica does not read on its own.
#include "host/image/picture.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::uint64_t max_bytes = std::uint64_t{64} << 20;
  static mica::fuzz::File file(".image");
  const std::string& path = file.write(bytes, size);
  for (const auto use : {mica::host::PictureUse::map, mica::host::PictureUse::color})
    mica::fuzz::refusing([&] {
      const mica::host::PictureChoice choice{"", "", max_bytes};
      const mica::host::PictureSize picture = mica::host::picture_size(path, choice, use);
      if (picture.width <= 0 || picture.height <= 0) std::abort();
    });
  return 0;
}
