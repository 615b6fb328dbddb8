#pragma once

#include <functional>
#include <vector>

#include "host/base/query.h"
#include "host/render/plan.h"
#include "host/scene/scene.h"

namespace mica::host {

/// Rows of a picture; by default those that the scene's camera sees, `scene.trace(first_row, row_count)`.
using TraceRows = std::function<TracedRows(const Scene& scene, int first_row, int row_count)>;

/// Some frames of a job, from one on.
struct FrameRange {
  int first = 0, count = 1;
};

constexpr int kMostBlocksLookedAt = 3;

/// Some of the queries that frames ask.
struct SomeQueries {
  std::vector<std::vector<Query>> of_evaluator;  ///< by PlannedEvaluator
  double scale = 1;                              ///< how many of the frames' queries each stands for
  std::vector<TracedRows> blocks;  ///< of a single frame's picture: whole blocks, kMostBlocksLookedAt at most
};

/// Traces some rows, at equal distances in the picture and in time: of a single frame a few of its blocks.
/// @param height of the picture. @param scene_at the scene at a frame.
SomeQueries queries_of_some_rows(const Plan& plan, int height, const FrameRange& frames,
                                 const std::function<Scene(int)>& scene_at, const TraceRows& trace);

}  // namespace mica::host
