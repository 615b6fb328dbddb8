#include "host/render/calibration_rows.h"

#include <algorithm>
#include <cmath>

#include "host/render/own_samples.h"

namespace mica::host {
namespace {

/// Rows of a strip: those that are traced around it, for its pixels' filter, are as many again.
constexpr int kRowsAStrip = 4;
constexpr int kHeightAStrip = 60;  // of the picture, one strip
constexpr int kFewestStrips = 2, kMostStrips = 6, kMostViews = 12;
constexpr double kGoldenRatio =
    0.6180339887498949;  // whose multiples, less whole numbers, fill [0, 1) evenly

void append_own(const TracedRows& rows, const Plan& plan, SomeQueries* queries) {
  const OwnSamples own(rows);
  for (const GlintQuery& glint : rows.queries)
    if (own.has(glint.sample))
      queries->of_evaluator[static_cast<std::size_t>(plan.evaluator_of_material[glint.material])].push_back(
          glint.query);
}

}  // namespace

SomeQueries queries_of_some_rows(const Plan& plan, int height, const FrameRange& frames,
                                 const std::function<Scene(int)>& scene_at, const TraceRows& trace) {
  const int views = std::min(frames.count, kMostViews), rows = std::min(kRowsAStrip, height),
            wanted = std::clamp(height / kHeightAStrip, kFewestStrips, kMostStrips),
            strips = std::clamp((wanted + views - 1) / views, 1, height / rows);
  SomeQueries queries{std::vector<std::vector<Query>>(plan.evaluators.size()), 1};
  for (int view = 0; view < views; ++view) {
    const Scene scene =
        scene_at(frames.first + static_cast<int>((2LL * view + 1) * frames.count / (2 * views)));
    const double shift = std::fmod(0.5 + kGoldenRatio * view, 1.0);  // other rows in every view
    for (int strip = 0; strip < strips; ++strip) {
      const int middle = static_cast<int>((strip + shift) * height / strips);
      append_own(trace(scene, std::clamp(middle - rows / 2, 0, height - rows), rows), plan, &queries);
    }
  }
  queries.scale = static_cast<double>(height) * frames.count / (static_cast<double>(rows) * strips * views);
  return queries;
}

}  // namespace mica::host
