#pragma once

#include <string>
#include <vector>

#include "host/measure/results.h"

namespace mica::host {

/// What less precision buys: an evaluator to several tolerances, on the same queries.
struct ToleranceCurve {
  const bench::Cell* cell = nullptr;
  struct Point {
    const bench::Measurement* measured = nullptr;
    double speed_ratio = 1;  ///< median speed over that of the first point
  };
  std::vector<Point> points;  ///< by tolerance; first what the evaluator keeps by itself
};

/// Of every evaluator of a cell that was measured by itself and to tolerances. Points to `results`.
std::vector<ToleranceCurve> tolerance_curves(const bench::Results& results);

/// A line each: ratios of speed, and errors. Empty without curves.
std::string tolerance_summary(const bench::Results& results);

/// The section of the page of `mica bench`: a chart of each surface and roughness, a curve of each footprint.
/// Empty without curves.
std::string tolerance_charts(const bench::Results& results);

}  // namespace mica::host
