#include "host/app/ndf_images.h"

#include <algorithm>

#include "host/app/progress.h"
#include "host/base/interrupt.h"
#include "host/base/stopwatch.h"

namespace mica::host::app {
namespace {

/// In chunks of some images, between which it checks for interrupts.
std::vector<float> paint_all(Painter* painter, std::size_t count,
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

}  // namespace

std::vector<float> draw_images(const OpenEvaluator& open, std::size_t count,
                               const std::function<Query(std::size_t)>& footprint,
                               const ImageWindow& window) {
  if (const std::unique_ptr<Painter> painter = open.evaluator->painter(count, footprint, window))
    return paint_all(painter.get(), count, footprint, window);
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
      open, queries / stride, [&](std::size_t n) { return query_of(n * stride); },
      static_cast<double>(stride));
  const std::vector<float> densities = evaluate_all(open.evaluator.get(), queries, query_of);
  std::vector<float> images(count * window.count());
  for (std::size_t n = 0; n < queries; ++n)
    images[n / pixels.size() * window.count() + pixels[n % pixels.size()]] = densities[n];
  return images;
}

}  // namespace mica::host::app
