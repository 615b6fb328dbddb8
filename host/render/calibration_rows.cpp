#include "host/render/calibration_rows.h"

#include <algorithm>
#include <cmath>

#include "host/render/own_samples.h"

namespace mica::host {
namespace {

constexpr int kMostViews = 12, kRowsOfView = 4;
constexpr double kGoldenRatio =
    0.6180339887498949;  // whose multiples, less whole numbers, fill [0, 1) evenly

void append_own(const TracedRows& rows, const Plan& plan, SomeQueries* queries) {
  const OwnSamples own(rows);
  for (const GlintQuery& glint : rows.queries)
    if (own.has(glint.sample))
      queries->of_evaluator[static_cast<std::size_t>(plan.evaluator_of_material[glint.material])].push_back(
          glint.query);
}

/// Of a single frame: blocks as rendering traces them, which it need not trace again.
void look_at_blocks(const Plan& plan, int height, const Scene& scene, const TraceRows& trace,
                    SomeQueries* queries) {
  const int rows = plan.rows_a_block, blocks = (height + rows - 1) / rows,
            some = std::min(kMostBlocksLookedAt, (blocks + 1) / 2);
  int traced = 0;
  for (int n = 0; n < some; ++n) {
    const int first = (2 * n + 1) * blocks / (2 * some) * rows;
    queries->blocks.push_back(trace(scene, first, std::min(rows, height - first)));
    append_own(queries->blocks.back(), plan, queries);
    traced += queries->blocks.back().row_count;
  }
  queries->scale = static_cast<double>(height) / traced;
}

}  // namespace

SomeQueries queries_of_some_rows(const Plan& plan, int height, const FrameRange& frames,
                                 const std::function<Scene(int)>& scene_at, const TraceRows& trace) {
  SomeQueries queries{std::vector<std::vector<Query>>(plan.evaluators.size()), 1, {}};
  if (frames.count == 1) {
    look_at_blocks(plan, height, scene_at(frames.first), trace, &queries);
    return queries;
  }
  const int views = std::min(frames.count, kMostViews), rows = std::min(kRowsOfView, height);
  for (int view = 0; view < views; ++view) {
    const Scene scene =
        scene_at(frames.first + static_cast<int>((2LL * view + 1) * frames.count / (2 * views)));
    const double place = std::fmod(0.5 + kGoldenRatio * view, 1.0);  // other rows in every view
    append_own(trace(scene, static_cast<int>(place * (height - rows + 1)), rows), plan, &queries);
  }
  queries.scale = static_cast<double>(height) * frames.count / (static_cast<double>(rows) * views);
  return queries;
}

}  // namespace mica::host
