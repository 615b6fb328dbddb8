#include "bench/bench_maps.h"

#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/surface/texel_footprint.h"

namespace mica::host::bench {
namespace {}  // namespace

Surface make_named(const std::string& name) {
  SurfaceDescription description;
  description.name = name;
  if (name == "spectrum") {
    description.source = SpectrumSurface{};
  } else if (name == "brushed") {
    description.source = BrushedSurface{};
  } else if (name == "flakes") {
    description.source = FlakesSurface{};
    description.interpolation = Interpolation::nearest;
  } else if (name == "scratches") {
    description.source = ScratchesSurface{};
  } else {
    MapFile file;
    file.path = name;
    file.invalid = TexelRepair::repair;
    description.source = file;
  }
  return make_surface(description, nullptr);
}

std::vector<Query> random_queries(const Surface& surface, double sigma_texels, double roughness,
                                  std::size_t count) {
  std::vector<Query> queries(count);
  for (std::size_t n = 0; n < count; ++n) {
    const auto random = [&](std::uint64_t stream) { return random_unit(7, stream, n); };
    const auto disk = [&](std::uint64_t stream) {
      const double radius = std::sqrt(-2 * std::log(1 - random(stream))),
                   angle = 2 * kPi * random(stream + 1);
      return Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
    };
    queries[n].footprint = make_footprint(surface, {random(0), random(1)}, sigma_texels, sigma_texels, 0);
    const Eigen::Vector2d place =
        Eigen::Vector2d(random(0) * surface.width(), random(1) * surface.height()) + sigma_texels * disk(2);
    const Eigen::Vector2d& normal = surface.texel(std::lround(place.x()), std::lround(place.y()));
    queries[n].half_vector = (normal + roughness * disk(4)).cwiseMax(-1).cwiseMin(1);
    queries[n].roughness = roughness;
  }
  return queries;
}

}  // namespace mica::host::bench
