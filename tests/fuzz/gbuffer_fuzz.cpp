// G-buffers: the first line is the camera and the lamps, JSON, the rest an EXR file.
#include <algorithm>

#include "host/gbuffer/gbuffer.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static mica::fuzz::File view_file(".json"), file(".exr");
  const std::uint8_t* const end = bytes + size;
  const std::uint8_t* const line_end = std::find(bytes, end, '\n');
  const std::string& view_path = view_file.write(bytes, static_cast<std::size_t>(line_end - bytes));
  const std::uint8_t* const rest = line_end == end ? end : line_end + 1;
  const std::string& path = file.write(rest, static_cast<std::size_t>(end - rest));
  mica::fuzz::refusing([&] { mica::host::ChannelFile(path).read(0, 1, {0}); });
  mica::fuzz::refusing([&] {
    const mica::host::BufferView view = mica::host::read_view(view_path);
    mica::host::MaterialDescription material;
    material.id = 1;
    mica::host::GBuffer buffer(path, view, {material}, 1, {{}, {}, true});
    buffer.read(-2, std::min(buffer.window().height + 4, 64), 2);
  });
  return 0;
}
