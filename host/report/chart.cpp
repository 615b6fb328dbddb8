#include "host/report/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace mica::host {
namespace {

constexpr double kLeft = 62, kRight = 24, kTop = 28, kBottom = 42;
const char* const kGrid = "#e6e6e6";
const char* const kAxis = "#9a9a9a";

/// A logarithmic axis between whole powers of ten, or of two where it spans little.
class LogAxis {
 public:
  LogAxis(double low, double high, double from, double to) : from_(from), to_(to) {
    base_ = high / low < 60 ? 2 : 10;
    first_ = static_cast<int>(std::floor(std::log(low) / std::log(base_) + 1e-9));
    last_ = std::max(static_cast<int>(std::ceil(std::log(high) / std::log(base_) - 1e-9)), first_ + 1);
  }
  double at(double value) const {
    return from_ + (to_ - from_) * (std::log(value) / std::log(base_) - first_) / (last_ - first_);
  }
  std::vector<double> ticks() const {
    const int step = (last_ - first_ + 7) / 8;
    std::vector<double> values;
    for (int power = first_; power <= last_; power += step) values.push_back(std::pow(base_, power));
    return values;
  }

 private:
  double from_, to_, base_;
  int first_, last_;
};

std::string tick_text(double value) {
  if (value >= 1e9) return fmt::format("{:.3g} G", value * 1e-9);
  if (value >= 1e6) return fmt::format("{:.3g} M", value * 1e-6);
  if (value >= 1e4) return fmt::format("{:.3g} k", value * 1e-3);
  if (value >= 1e-3) return fmt::format("{:.4g}", value);
  return fmt::format("{:.0e}", value);
}

/// Points than which none is both faster and closer, from slow to fast.
std::vector<ChartPoint> pareto_front(const Chart& chart) {
  std::vector<ChartPoint> all;
  for (const ChartSeries& series : chart.series)
    all.insert(all.end(), series.points.begin(), series.points.end());
  std::sort(all.begin(), all.end(), [](const ChartPoint& a, const ChartPoint& b) { return a.x > b.x; });
  std::vector<ChartPoint> front;
  for (const ChartPoint& point : all)
    if (front.empty() || point.y < front.back().y) front.push_back(point);
  std::reverse(front.begin(), front.end());
  return front;
}

struct Axes {
  LogAxis x, y;
};

Axes axes_of(const Chart& chart) {
  double x_low = 1e300, x_high = 0, y_low = 1e300, y_high = 0;
  for (const ChartSeries& series : chart.series) {
    for (const ChartPoint& point : series.points) {
      x_low = std::min(x_low, point.x), x_high = std::max(x_high, point.x);
      y_low = std::min(y_low, point.y), y_high = std::max(y_high, point.y);
    }
  }
  if (x_high == 0) x_low = y_low = 1, x_high = y_high = 10;
  return {LogAxis(x_low / 1.05, x_high * 1.05, kLeft, chart.width - kRight),
          LogAxis(y_low / 1.15, y_high * 1.15, chart.height - kBottom, kTop)};
}

void draw_frame(const Chart& chart, const Axes& axes, Svg* svg) {
  const double bottom = chart.height - kBottom, right = chart.width - kRight;
  for (const double x : axes.x.ticks()) {
    svg->line(axes.x.at(x), kTop, axes.x.at(x), bottom, kGrid, 1);
    svg->text(axes.x.at(x), bottom + 14, tick_text(x), Anchor::middle, 10);
  }
  for (const double y : axes.y.ticks()) {
    svg->line(kLeft, axes.y.at(y), right, axes.y.at(y), kGrid, 1);
    svg->text(kLeft - 6, axes.y.at(y) + 3.5, tick_text(y), Anchor::end, 10);
  }
  svg->line(kLeft, bottom, right, bottom, kAxis, 1);
  svg->line(kLeft, kTop, kLeft, bottom, kAxis, 1);
  svg->text(kLeft, 16, chart.title, Anchor::start, 12.5, "#222222");
  svg->text((kLeft + right) / 2, chart.height - 10, chart.x_label, Anchor::middle);
  svg->text(13, (kTop + bottom) / 2, chart.y_label, Anchor::middle, 11, "#444444", true);
}

}  // namespace

Style style_of(const std::string& evaluator) {
  static const std::map<std::string, Style> styles = {
      {"triangles", {"#0072b2", Marker::circle}},  {"gaussians", {"#d55e00", Marker::square}},
      {"beckmanns", {"#e69f00", Marker::diamond}}, {"pyramid", {"#009e73", Marker::up}},
      {"smooth", {"#cc79a7", Marker::down}},       {"cavities", {"#7a5195", Marker::plus}},
      {"grid", {"#56b4e9", Marker::bar}},          {"brute force", {"#777777", Marker::cross}},
      {"reference", {"#222222", Marker::cross}}};
  const auto found = styles.find(evaluator);
  return found == styles.end() ? Style{"#555555", Marker::plus} : found->second;
}

std::string draw(const Chart& chart) {
  Svg svg(chart.width, chart.height);
  const Axes axes = axes_of(chart);
  draw_frame(chart, axes, &svg);
  if (chart.pareto) {
    std::vector<std::pair<double, double>> line;
    for (const ChartPoint& point : pareto_front(chart))
      line.emplace_back(axes.x.at(point.x), axes.y.at(point.y));
    if (line.size() > 1) svg.polyline(line, "#bdbdbd", 6);
  }
  for (const ChartSeries& series : chart.series) {
    const Style style = style_of(series.evaluator);
    if (series.connected) {
      std::vector<std::pair<double, double>> line;
      for (const ChartPoint& point : series.points) line.emplace_back(axes.x.at(point.x), axes.y.at(point.y));
      svg.polyline(line, style.color, 1.6, series.dashed);
    }
    for (const ChartPoint& point : series.points) {
      svg.marker(style.marker, axes.x.at(point.x), axes.y.at(point.y), 5, style.color, point.tooltip);
      if (!point.tag.empty())
        svg.text(axes.x.at(point.x) + 8, axes.y.at(point.y) - 4, point.tag, Anchor::start, 10, style.color);
    }
  }
  return svg.str();
}

std::string draw_legend(const std::vector<std::string>& evaluators) {
  double x = 10;
  constexpr double width_a_letter = 6.6;
  Svg svg(130.0 * static_cast<double>(evaluators.size()), 22);
  for (const std::string& name : evaluators) {
    svg.marker(style_of(name).marker, x, 11, 5.5, style_of(name).color);
    svg.text(x + 10, 15, name, Anchor::start, 12, "#222222");
    x += 40 + width_a_letter * static_cast<double>(name.size());
  }
  return svg.str();
}

std::string draw_bars(const std::vector<Bar>& bars) {
  constexpr double row = 22, label_width = 210, bar_width = 360, value_width = 110;
  Svg svg(label_width + bar_width + value_width, row * static_cast<double>(bars.size()) + 4);
  double longest = 0, y = 2;
  for (const Bar& bar : bars) longest = std::max(longest, bar.value);
  for (const Bar& bar : bars) {
    const double length = longest > 0 ? bar_width * bar.value / longest : 0;
    svg.text(label_width - 8, y + 14, bar.label, Anchor::end, 11.5, "#222222");
    svg.rectangle(label_width, y + 3, std::max(length, 1.0), row - 7, style_of(bar.evaluator).color,
                  bar.value_text);
    svg.text(label_width + length + 6, y + 14, bar.value_text);
    y += row;
  }
  return svg.str();
}

}  // namespace mica::host
