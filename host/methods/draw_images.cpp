#include "host/methods/draw_images.h"

#include <algorithm>

#include "host/base/chunks.h"

namespace mica::host {
namespace {

constexpr std::size_t kPixelsAChunk = std::size_t{1} << 20;

/// A method that chooses among others looks at some of the pixels: the footprints are all of one size.
void calibrate_by_pixels(Evaluator* evaluator, std::size_t queries, const QuerySource& query_of) {
  constexpr std::size_t looked_at = 1 << 16;
  const std::size_t stride = std::max<std::size_t>(queries / looked_at, 1);
  evaluator->calibrate(
      queries / stride, [&](std::size_t n) { return query_of(n * stride); }, static_cast<double>(stride));
}

using Between = std::function<void(std::size_t)>;

std::vector<float> paint_all(Painter* painter, std::size_t count, const QuerySource& footprint,
                             const ImageWindow& window, const Between& between) {
  const std::size_t chunk = std::max<std::size_t>(kPixelsAChunk / window.count(), 1);
  std::vector<float> images;
  images.reserve(count * window.count());
  for (std::size_t first = 0; first < count; first += chunk) {
    between(first);
    std::vector<Query> footprints(std::min(chunk, count - first));
    for (std::size_t n = 0; n < footprints.size(); ++n) footprints[n] = footprint(first + n);
    const std::vector<float> some = painter->paint(footprints, window);
    images.insert(images.end(), some.begin(), some.end());
  }
  between(count);
  return images;
}

}  // namespace

std::vector<float> draw_images(Evaluator& evaluator, std::size_t count, const QuerySource& footprint,
                               const ImageWindow& window, const Between& between) {
  if (count == 0) return {};
  if (const std::unique_ptr<Painter> painter = evaluator.painter(count, footprint, window))
    return paint_all(painter.get(), count, footprint, window, between);
  const std::vector<std::size_t> pixels = window.pixels_on_disk();
  const auto query_of = [&](std::size_t n) {
    Query query = footprint(n / pixels.size());
    query.half_vector = window.half_vector(pixels[n % pixels.size()]);
    return query;
  };
  const std::size_t queries = count * pixels.size();
  if (queries > 0) calibrate_by_pixels(&evaluator, queries, query_of);
  std::vector<float> images(count * window.count());
  std::vector<Query> some;
  const auto answer = [&](std::size_t first, std::size_t number) {
    some.resize(number);
    for (std::size_t n = 0; n < number; ++n) some[n] = query_of(first + n);
    const std::vector<float> densities = evaluator.evaluate(some);
    for (std::size_t n = first; n < first + number; ++n)
      images[n / pixels.size() * window.count() + pixels[n % pixels.size()]] = densities[n - first];
  };
  work_in_chunks(queries, answer,
                 [&](std::size_t done) { between(done / std::max<std::size_t>(pixels.size(), 1)); });
  return images;
}

}  // namespace mica::host
