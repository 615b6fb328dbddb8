// Meshes: what is read has corners that are there, and finite ones.
#include "host/scene/obj.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static mica::fuzz::File file(".obj");
  const std::string& path = file.write(bytes, size);
  mica::fuzz::refusing([&] {
    const mica::host::TriangleMesh mesh = mica::host::load_obj(path);
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle)
        if (corner >= mesh.positions.size() || !mesh.positions[corner].allFinite()) std::abort();
  });
  return 0;
}
