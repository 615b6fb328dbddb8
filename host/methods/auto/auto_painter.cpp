// How `auto` draws images: element by element, where that keeps its tolerance.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "host/base/error_norms.h"
#include "host/methods/auto/auto_evaluator.h"
#include "host/methods/pyramid/pyramid_painter.h"
#include "host/methods/triangles/triangle_evaluator.h"

namespace mica::host {
namespace {

/// A painter with the pyramid that it draws by.
class OwnPyramidPainter : public Painter {
 public:
  OwnPyramidPainter(Device& device, const Surface& surface)
      : pyramid_(device, surface), painter_(device, surface, pyramid_) {}
  std::vector<float> paint(const std::vector<Query>& footprints, const ImageWindow& window) override {
    return painter_.paint(footprints, window);
  }

 private:
  PyramidEvaluator pyramid_;
  PyramidPainter painter_;
};

/// Largest relative L2 of images that a painter draws, against `triangles`: of some footprints, from the
/// smallest to the largest roughness, in fewer pixels.
double largest_error(Painter* painter, Device& device, const Surface& surface, std::size_t count,
                     const QuerySource& footprint, ImageWindow window) {
  constexpr std::size_t samples = 8;
  window.pixels = std::min(window.pixels, 24);
  std::vector<Query> all(count);
  for (std::size_t n = 0; n < count; ++n) all[n] = footprint(n);
  std::stable_sort(all.begin(), all.end(),
                   [](const Query& a, const Query& b) { return a.roughness < b.roughness; });
  TriangleEvaluator triangles(device, surface);
  const std::vector<std::size_t> pixels = window.pixels_on_disk();
  double largest = 0;
  for (std::size_t n = 0; n < std::min(samples, count); ++n) {
    const Query& one = all[n * (count - 1) / std::max<std::size_t>(std::min(samples, count) - 1, 1)];
    const std::vector<float> image = painter->paint({one}, window);
    std::vector<Query> queries(pixels.size(), one);
    for (std::size_t k = 0; k < pixels.size(); ++k) queries[k].half_vector = window.half_vector(pixels[k]);
    const std::vector<float> expected = triangles.evaluate(queries);
    RelativeL2 error;
    for (std::size_t k = 0; k < pixels.size(); ++k) error.add(image[pixels[k]], expected[k]);
    if (error.has_reference()) largest = std::max(largest, error.value());
  }
  return largest;
}

}  // namespace

std::unique_ptr<Painter> AutoEvaluator::painter(std::size_t count, const QuerySource& footprint,
                                                const ImageWindow& window) {
  constexpr double safety = 2;  // the images looked at are few
  auto painter = std::make_unique<OwnPyramidPainter>(device_, surface_);
  const double error = largest_error(painter.get(), device_, surface_, count, footprint, window);
  if (!(safety * error <= tolerance_)) return nullptr;
  spdlog::info("auto: images are drawn element by element; relative L2 of those looked at {:.2g}", error);
  return painter;
}

}  // namespace mica::host
