#include "host/app/ndf_images.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "host/app/interrupt.h"
#include "host/app/progress.h"
#include "host/base/stopwatch.h"
#include "host/methods/auto/auto_evaluator.h"
#include "host/methods/pyramid/pyramid_painter.h"
#include "host/methods/triangles/triangle_evaluator.h"

namespace mica::host::app {
namespace {

/// In chunks of some images, between which it checks for interrupts.
std::vector<float> paint_all(PyramidPainter* painter, std::size_t count,
                             const std::function<Query(std::size_t)>& footprint, const ImageWindow& window) {
  constexpr std::size_t pixels_a_chunk = 1 << 20;
  const std::size_t chunk = std::max<std::size_t>(pixels_a_chunk / window.count(), 1);
  Progress progress("images", false);
  const Stopwatch watch;
  std::vector<float> images;
  images.reserve(count * window.count());
  for (std::size_t first = 0; first < count; first += chunk) {
    check_interrupt();
    std::vector<Query> footprints(std::min(chunk, count - first));
    for (std::size_t n = 0; n < footprints.size(); ++n) footprints[n] = footprint(first + n);
    const std::vector<float> some = painter->paint(footprints, window);
    images.insert(images.end(), some.begin(), some.end());
    if (watch.seconds() > 1)
      progress.update(static_cast<long>(first + footprints.size()), static_cast<long>(count));
  }
  check_interrupt();
  return images;
}

/// Largest relative L2 of images that a painter draws, against `triangles`: of some footprints, from the
/// smallest to the largest roughness, in fewer pixels.
double largest_error(PyramidPainter* painter, Device* device, const Surface& surface, std::size_t count,
                     const std::function<Query(std::size_t)>& footprint, ImageWindow window) {
  constexpr std::size_t samples = 8;
  window.pixels = std::min(window.pixels, 24);
  std::vector<Query> all(count);
  for (std::size_t n = 0; n < count; ++n) all[n] = footprint(n);
  std::stable_sort(all.begin(), all.end(),
                   [](const Query& a, const Query& b) { return a.roughness < b.roughness; });
  TriangleEvaluator triangles(*device, surface);
  const std::vector<std::size_t> pixels = window.pixels_on_disk();
  double largest = 0;
  for (std::size_t n = 0; n < std::min(samples, count); ++n) {
    const Query& one = all[n * (count - 1) / std::max<std::size_t>(std::min(samples, count) - 1, 1)];
    const std::vector<float> image = painter->paint({one}, window);
    std::vector<Query> queries(pixels.size(), one);
    for (std::size_t k = 0; k < pixels.size(); ++k) queries[k].half_vector = window.half_vector(pixels[k]);
    const std::vector<float> expected = triangles.evaluate(queries);
    double squares = 0, references = 0;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      squares += std::pow(image[pixels[k]] - expected[k], 2);
      references += std::pow(expected[k], 2);
    }
    if (references > 0) largest = std::max(largest, std::sqrt(squares / references));
  }
  return largest;
}

}  // namespace

std::vector<float> draw_images(const OpenEvaluator& open, const Surface& surface, std::size_t count,
                               const std::function<Query(std::size_t)>& footprint,
                               const ImageWindow& window) {
  if (auto* const pyramid = dynamic_cast<PyramidEvaluator*>(open.evaluator.get()); pyramid != nullptr) {
    PyramidPainter painter(*open.device, surface, *pyramid);
    return paint_all(&painter, count, footprint, window);
  }
  if (const auto* const chooser = dynamic_cast<AutoEvaluator*>(open.evaluator.get()); chooser != nullptr) {
    constexpr double safety = 2;  // the images looked at are few
    PyramidEvaluator pyramid(*open.device, surface);
    PyramidPainter painter(*open.device, surface, pyramid);
    const double error = largest_error(&painter, open.device.get(), surface, count, footprint, window);
    if (safety * error <= chooser->tolerance()) {
      spdlog::info("auto: images are drawn element by element; relative L2 of those looked at {:.2g}", error);
      return paint_all(&painter, count, footprint, window);
    }
  }
  const std::vector<std::size_t> pixels = window.pixels_on_disk();
  const auto query_of = [&](std::size_t n) {
    Query query = footprint(n / pixels.size());
    query.half_vector = window.half_vector(pixels[n % pixels.size()]);
    return query;
  };
  const std::size_t queries = count * pixels.size();
  constexpr std::size_t looked_at = 1 << 16;  // by the calibration: the footprints are all of one size
  const std::size_t stride = std::max<std::size_t>(queries / looked_at, 1);
  calibrate(
      open, surface, queries / stride, [&](std::size_t n) { return query_of(n * stride); },
      static_cast<double>(stride));
  const std::vector<float> densities = evaluate_all(open.evaluator.get(), queries, query_of);
  std::vector<float> images(count * window.count());
  for (std::size_t n = 0; n < queries; ++n)
    images[n / pixels.size() * window.count() + pixels[n % pixels.size()]] = densities[n];
  return images;
}

}  // namespace mica::host::app
