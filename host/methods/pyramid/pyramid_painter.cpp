#include "host/methods/pyramid/pyramid_painter.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "host/methods/map/map_query.h"
#include "host/methods/map/map_structure.h"

namespace mica::host {
namespace {

/// Elements are culled one by one, and cost too little for the pyramid's rough cutoff to be worth its error.
constexpr double kCutoffError = 3e-4;

/// Pieces of texels are Gaussians, which shows where a footprint is no wider than they are.
constexpr double kSmallestSigmaTexels = 2;

}  // namespace

PyramidPainter::PyramidPainter(Device& device, const Surface& surface, PyramidEvaluator& pyramid)
    : device_(device),
      surface_(surface),
      pyramid_(pyramid),
      cutoff_(cutoff_for(std::min(kCutoffError, pyramid.settings().precision.cutoff_error))) {}

PyramidPainter::Way PyramidPainter::way(const Query& query) {
  if (pyramid_.choose(query)) return Way::level;
  const FootprintAxes axes =
      footprint_axes(without_needless_periods(query.footprint), surface_.width(), surface_.height());
  // Thinner ones have a determinant that single precision cannot tell.
  const bool wide = axes.sigma_minor_texels >= kSmallestSigmaTexels &&
                    axes.sigma_major_texels <= kLargestAspect * axes.sigma_minor_texels;
  return wide && surface_.interpolation() != Interpolation::bicubic ? Way::texels : Way::queries;
}

std::vector<float> PyramidPainter::paint(const std::vector<Query>& footprints, const ImageWindow& window) {
  std::map<PyramidChoice, std::vector<std::size_t>> by_level;
  std::vector<std::size_t> by_texels, by_queries;
  for (std::size_t n = 0; n < footprints.size(); ++n) {
    switch (way(footprints[n])) {
      case Way::level:
        by_level[*pyramid_.choose(footprints[n])].push_back(n);
        break;
      case Way::texels:
        by_texels.push_back(n);
        break;
      case Way::queries:
        by_queries.push_back(n);
        break;
    }
  }
  std::vector<float> images(footprints.size() * window.count());
  const auto draw = [&](const std::vector<std::size_t>& places, const auto& method) {
    if (places.empty()) return;
    std::vector<Query> some;
    for (const std::size_t place : places) some.push_back(footprints[place]);
    const std::vector<float> drawn = method(some);
    for (std::size_t n = 0; n < places.size(); ++n)
      std::copy_n(drawn.begin() + static_cast<long>(n * window.count()), window.count(),
                  images.begin() + static_cast<long>(places[n] * window.count()));
  };
  for (const auto& [choice, places] : by_level)
    draw(places, [&, &choice = choice](const auto& some) { return paint_level(some, choice, window); });
  draw(by_texels, [&](const auto& some) { return paint_texels(some, window); });
  draw(by_queries, [&](const auto& some) { return paint_queries(some, window); });
  return images;
}

std::vector<float> PyramidPainter::paint_level(const std::vector<Query>& footprints,
                                               const PyramidChoice& choice, const ImageWindow& window) {
  const PyramidLevelBatches& level = pyramid_.level(choice);
  const PyramidChoice key{choice.cell_class, choice.block, false};
  auto found = levels_.find(key);
  if (found == levels_.end())
    found = levels_
                .try_emplace(key, device_, level.shape().grid, level.buffers(), "images/pyramid_images",
                             fmt::format("-DMICA_RECORD_BITS={}", level.shape().record_bits),
                             pyramid_.wave_form())
                .first;
  std::vector<device_types::mica_pyramid_query> queries(footprints.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    queries[n] =
        to_pyramid_query(footprints[n], level.shape(), surface_.interpolation(), cutoff_, choice.uniform);
  });
  return found->second.draw(queries, window);
}

std::vector<float> PyramidPainter::paint_texels(const std::vector<Query>& footprints,
                                                const ImageWindow& window) {
  PyramidShape shape;  // of which a query takes the map's size
  shape.grid = {surface_.width(), surface_.height(), 0, 0};
  if (!texels_) {
    const MapStructure map = build_map_structure(surface_);
    texels_.emplace(device_, map.grid,
                    std::vector<cl::Buffer>{device_.upload(map.normals, "the map's normals"),
                                            device_.upload(map.block_nodes, "the map's bounds"),
                                            device_.upload(map.tile_nodes, "the map's bounds")},
                    "images/texel_images",
                    fmt::format("-DMICA_INTERPOLATION={}", static_cast<int>(surface_.interpolation())),
                    pyramid_.wave_form());
  }
  std::vector<device_types::mica_pyramid_query> queries(footprints.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    queries[n] = to_pyramid_query(footprints[n], shape, surface_.interpolation(), cutoff_, false);
  });
  return texels_->draw(queries, window);
}

std::vector<float> PyramidPainter::paint_queries(const std::vector<Query>& footprints,
                                                 const ImageWindow& window) {
  const std::vector<std::size_t> pixels = window.pixels_on_disk();
  std::vector<float> images(footprints.size() * window.count());
  std::vector<Query> queries(pixels.size());
  for (std::size_t image = 0; image < footprints.size(); ++image) {
    for (std::size_t n = 0; n < pixels.size(); ++n) {
      queries[n] = footprints[image];
      queries[n].half_vector = window.half_vector(pixels[n]);
    }
    const std::vector<float> densities = pyramid_.evaluate(queries);
    for (std::size_t n = 0; n < pixels.size(); ++n) images[image * window.count() + pixels[n]] = densities[n];
  }
  return images;
}

std::unique_ptr<Painter> PyramidEvaluator::painter(std::size_t, const QuerySource&, const ImageWindow&) {
  return std::make_unique<PyramidPainter>(device_, surface_, *this);
}

}  // namespace mica::host
