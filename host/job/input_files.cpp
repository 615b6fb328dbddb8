#include "host/job/input_files.h"

#include "host/base/hash.h"

namespace mica::host {

std::vector<std::string> input_files(const SurfaceDescription& surface) {
  if (const auto* map = std::get_if<MapFile>(&surface.source)) return {map->path};
  std::vector<std::string> files;
  if (const auto* layers = std::get_if<LayersSurface>(&surface.source))
    for (const SurfaceLayer& layer : layers->layers)
      for (std::string& file : input_files(layer.surface)) files.push_back(std::move(file));
  return files;
}

std::vector<std::string> input_files(const Job& job) {
  std::vector<std::string> files = {job.path, job.scene.background.path};
  for (const SurfaceDescription& surface : job.surfaces)
    for (std::string& file : input_files(surface)) files.push_back(std::move(file));
  for (const EnvironmentLight& light : job.scene.environments) files.push_back(light.path);
  for (const ShapeDescription& shape : job.scene.shapes)
    if (const auto* mesh = std::get_if<MeshShape>(&shape.geometry)) files.push_back(mesh->path);
  for (const MaterialDescription& material : job.scene.materials) {
    if (!material.glints) continue;
    const GlintTextures& t = material.glints->textures;
    files.insert(files.end(), {t.density, t.alpha, t.microroughness, t.stretch, t.color});
  }
  return files;
}

std::string hash_of_inputs(const Job& job) {
  std::string hashes;
  for (const std::string& path : input_files(job)) {
    if (path.empty() || path == job.path) continue;
    hashes += hash_of_file(path);
  }
  return hashes.empty() ? hashes : hash_of_bytes(hashes.data(), hashes.size());
}

}  // namespace mica::host
