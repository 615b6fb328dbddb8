#include "host/scene/part_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <variant>

#include "mica/error.h"

namespace mica::host {
namespace {

std::uint32_t material_index(const SceneDescription& description, std::size_t shape,
                             const std::string& name) {
  const auto found = std::find_if(description.materials.begin(), description.materials.end(),
                                  [&](const MaterialDescription& m) { return m.name == name; });
  if (found == description.materials.end())
    throw UsageError(fmt::format("shape {}: there is no material '{}'", shape + 1, name));
  return static_cast<std::uint32_t>(found - description.materials.begin());
}

std::string file_of(const ShapeDescription& shape) {
  const auto* mesh = std::get_if<MeshShape>(&shape.geometry);
  return mesh ? ", " + mesh->path : "";
}

/// Faces before the first `usemtl` are a part without a name.
std::string list_of(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + (part.empty() ? "''" : part);
  return text.empty() ? "none" : text;
}

}  // namespace

PartMaterials materials_of_parts(const SceneDescription& description, const Geometry& geometry) {
  PartMaterials materials;
  for (std::size_t n = 0; n < description.shapes.size(); ++n) {
    const ShapeDescription& shape = description.shapes[n];
    const std::vector<std::string>& parts = geometry.parts(n);
    materials.emplace_back(std::max<std::size_t>(parts.size(), 1),
                           material_index(description, n, shape.material));
    for (const PartMaterial& wanted : shape.parts) {
      const auto part = std::find(parts.begin(), parts.end(), wanted.part);
      if (part == parts.end())
        throw UsageError(fmt::format("shape {}{}: found no part '{}'; its parts are: {}", n + 1,
                                     file_of(shape), wanted.part, list_of(parts)));
      materials[n][static_cast<std::size_t>(part - parts.begin())] =
          material_index(description, n, wanted.material);
    }
  }
  return materials;
}

}  // namespace mica::host
