#include "host/report/tolerance_curves.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/report/chart.h"

namespace mica::host {
namespace {

using bench::Cell;
using bench::Measurement;

ToleranceCurve curve_from(const Cell& cell, const Measurement& own) {
  ToleranceCurve curve{&cell, {{&own, 1}}};
  for (const Measurement& m : cell.measurements)
    if (m.evaluator == own.evaluator && m.tolerance > 0 && m.refused.empty())
      curve.points.push_back({&m, m.speed.median / own.speed.median});
  std::sort(curve.points.begin() + 1, curve.points.end(),
            [](const auto& a, const auto& b) { return a.measured->tolerance < b.measured->tolerance; });
  return curve;
}

ChartSeries series_of(const ToleranceCurve& curve) {
  constexpr double least_error = 1e-7;  // charts cannot show zero
  ChartSeries series{curve.points[0].measured->evaluator, {}, true, false};
  for (const ToleranceCurve::Point& point : curve.points) {
    const Measurement& m = *point.measured;
    series.points.push_back(
        {std::max(m.errors.relative_l2, least_error), point.speed_ratio, "",
         fmt::format("{}, σ {} texels: {:.2f} times the speed, relative L2 {:.2g}", m.label,
                     curve.cell->sigma_texels, point.speed_ratio, m.errors.relative_l2)});
  }
  series.points.back().tag = fmt::format("σ {}", curve.cell->sigma_texels);
  return series;
}

bool same_chart(const Cell& a, const Cell& b) {
  return a.surface == b.surface && a.roughness == b.roughness;
}

}  // namespace

std::vector<ToleranceCurve> tolerance_curves(const bench::Results& results) {
  std::vector<ToleranceCurve> curves;
  for (const Cell& cell : results.cells) {
    for (const Measurement& own : cell.measurements) {
      if (own.tolerance > 0 || !own.knob.empty() || !own.refused.empty()) continue;
      ToleranceCurve curve = curve_from(cell, own);
      if (curve.points.size() > 1) curves.push_back(std::move(curve));
    }
  }
  return curves;
}

std::string tolerance_summary(const bench::Results& results) {
  std::string text;
  for (const ToleranceCurve& curve : tolerance_curves(results)) {
    if (text.empty()) text = "speed over that of exact answers, and relative L2, to a tolerance\n";
    text += fmt::format("{:<10} {:>6} {:>9} {:<10}", curve.cell->surface, curve.cell->sigma_texels,
                        curve.cell->roughness, curve.points[0].measured->evaluator);
    for (std::size_t n = 1; n < curve.points.size(); ++n)
      text += fmt::format("  {:g}: {:.2f}x {:.1e}", curve.points[n].measured->tolerance,
                          curve.points[n].speed_ratio, curve.points[n].measured->errors.relative_l2);
    text += "\n";
  }
  return text;
}

std::string tolerance_charts(const bench::Results& results) {
  std::vector<std::pair<const Cell*, Chart>> charts;
  for (const ToleranceCurve& curve : tolerance_curves(results)) {
    auto place = std::find_if(charts.begin(), charts.end(), [&](const auto& chart) {
      return same_chart(*chart.first, *curve.cell) &&
             chart.second.series[0].evaluator == curve.points[0].measured->evaluator;
    });
    if (place == charts.end()) {
      Chart chart;
      chart.title = fmt::format("{}, {}, roughness {}", curve.points[0].measured->evaluator,
                                curve.cell->surface, curve.cell->roughness);
      chart.x_label = "relative L2 error", chart.y_label = "speed over exact";
      place = charts.insert(charts.end(), {curve.cell, std::move(chart)});
    }
    place->second.series.push_back(series_of(curve));
  }
  if (charts.empty()) return "";
  std::string html =
      "<h2>Speed against tolerance</h2>\n<p>What less precision buys: each curve begins at the exact answers "
      "and has a mark for each tolerance asked for, larger ones further right; a curve of each footprint. "
      "The ratio is to exact answers of this run.</p>\n<div class=\"row\">";
  for (const auto& chart : charts) html += draw(chart.second);
  return html + "</div>\n";
}

}  // namespace mica::host
