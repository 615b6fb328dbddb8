#pragma once

#include <string>
#include <vector>

#include "host/report/svg.h"

namespace mica::host {

/// How an evaluator is drawn everywhere: colours that colour-blind eyes tell apart (Okabe and Ito), and a
/// shape of its own besides.
struct Style {
  std::string color;
  Marker marker = Marker::circle;
};
Style style_of(const std::string& evaluator);

struct ChartPoint {
  double x = 0, y = 0;
  std::string tag;  ///< a character or two beside the marker
  std::string tooltip;
};
struct ChartSeries {
  std::string evaluator;
  std::vector<ChartPoint> points;
  bool connected = false, dashed = false;
};

/// A chart with two logarithmic axes.
struct Chart {
  std::string title, x_label, y_label;
  std::vector<ChartSeries> series;
  bool pareto = false;  ///< draws the front of points than which none is both further right and lower
  double width = 358, height = 250;
};
std::string draw(const Chart& chart);

/// Markers and names of the evaluators, in a row.
std::string draw_legend(const std::vector<std::string>& evaluators);

/// Horizontal bars from zero, longest value at full width.
struct Bar {
  std::string evaluator, label, value_text;
  double value = 0;
};
std::string draw_bars(const std::vector<Bar>& bars);

}  // namespace mica::host
