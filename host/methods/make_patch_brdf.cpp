#include "host/methods/make_patch_brdf.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/methods/baseline/normal_map_brdf.h"
#include "host/methods/beckmanns/beckmann_brdf.h"
#include "host/methods/cavities/cavity_brdf.h"
#include "host/methods/map/map_query.h"
#include "mica/error.h"

namespace mica::host {

const std::vector<std::string>& masking_names() {
  static const std::vector<std::string> names = {"exact", "filtered", "geometric"};
  return names;
}

const std::vector<std::string>& patch_brdf_names() {
  static const std::vector<std::string> names = {"beckmanns", "cavities", "normalmap"};
  return names;
}

std::unique_ptr<PatchBrdf> make_patch_brdf(const std::string& name, Device& device, const Surface& surface,
                                           const PatchBrdfSettings& settings) {
  if (name == "beckmanns") return std::make_unique<BeckmannBrdf>(device, surface, settings);
  if (name == "cavities") {
    CavitySettings cavities;
    cavities.compensation = settings.compensation;
    cavities.energy = settings.energy;
    cavities.per_texel = settings.elements;
    return std::make_unique<CavityBrdf>(device, surface, cavities);
  }
  if (name == "normalmap") return std::make_unique<NormalMapBrdf>(surface);
  throw UsageError(
      fmt::format("\"{}\" has no BRDF of its own; available: {}", name, fmt::join(patch_brdf_names(), ", ")));
}

std::string view_problem(const ViewQuery& query, int map_width, int map_height) {
  return query_problem({query.footprint, Eigen::Vector2d::Zero(), query.roughness}, map_width, map_height);
}

}  // namespace mica::host
