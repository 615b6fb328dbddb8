#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/report/bench_report.h"
#include "host/report/chart.h"
#include "host/report/page_images.h"
#include "host/report/tolerance_curves.h"
#include "mica/version.h"

namespace mica::host {
namespace {

using bench::Cell;
using bench::Measurement;
using bench::Picture;
using bench::PictureRow;
using bench::Results;

const char* const kStyle = R"(
body { max-width: 1180px; margin: 2.5em auto 5em; padding: 0 1.5em; color: #222; background: #fff;
       font: 16px/1.55 "Source Sans 3", "Segoe UI", "Helvetica Neue", "DejaVu Sans", Arial, sans-serif; font-weight: 400; }
h1 { font-weight: 300; font-size: 2.3em; margin: 0 0 .1em; letter-spacing: -.01em; }
h2 { font-weight: 400; font-size: 1.4em; margin: 2.4em 0 .4em; border-bottom: 1px solid #e4e4e4; padding-bottom: .2em; }
h3 { font-weight: 600; font-size: 1em; margin: 1.4em 0 .3em; }
p, li { max-width: 46em; } .facts { color: #666; }
svg text { font-family: inherit; }
.row { display: flex; flex-wrap: wrap; gap: 14px 22px; align-items: flex-start; }
figure { margin: 0; } figcaption { font-size: 13px; line-height: 1.35; color: #555; max-width: 16em; margin-top: 3px; }
img { image-rendering: pixelated; display: block; border: 1px solid #ddd; }
table { border-collapse: collapse; font-size: 13.5px; line-height: 1.3; } th { font-weight: 600; text-align: left; }
td, th { padding: 3px 12px 3px 0; border-bottom: 1px solid #eee; } td.n { text-align: right; font-variant-numeric: tabular-nums; }
summary { cursor: pointer; color: #0b5cad; margin: 1em 0 .4em; }
)";

std::string paragraph(const std::string& text) {
  return "<p>" + text + "</p>\n";
}

std::string percent(double share) {
  const double p = 100 * share;
  if (p == 0) return "0 %";
  return p < 0.001 ? fmt::format("{:.0e} %", p) : fmt::format("{:.2g} %", p);
}

std::string mebibytes(std::size_t bytes) {
  return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
}

std::string rate(double per_second) {
  if (per_second >= 1e6) return fmt::format("{:.2f} M/s", per_second * 1e-6);
  if (per_second >= 1e3) return fmt::format("{:.1f} k/s", per_second * 1e-3);
  return fmt::format("{:.1f} /s", per_second);
}

std::string duration(double seconds) {
  if (seconds < 1) return fmt::format("{:.0f} ms", 1000 * seconds);
  if (seconds < 120) return fmt::format("{:.1f} s", seconds);
  if (seconds < 7200) return fmt::format("{:.0f} minutes", seconds / 60);
  if (seconds < 172800) return fmt::format("{:.0f} hours", seconds / 3600);
  return fmt::format("{:.0f} days", seconds / 86400);
}

/// Evaluators in the order of the registry, once each.
std::vector<std::string> evaluators_of(const Results& results) {
  std::vector<std::string> names;
  for (const Cell& cell : results.cells)
    for (const Measurement& m : cell.measurements)
      if (m.refused.empty() && std::find(names.begin(), names.end(), m.evaluator) == names.end())
        names.push_back(m.evaluator);
  return names;
}

std::string tooltip(const Measurement& m) {
  return fmt::format("{}: {} ({} to {}), relative L2 {}, {}", m.label, rate(m.speed.median),
                     rate(m.speed.slowest), rate(m.speed.fastest), percent(m.errors.relative_l2),
                     mebibytes(m.device_bytes));
}

constexpr double kLeastError = 1e-7;  // what single precision can answer; charts cannot show zero

std::string scatter(const Cell& cell) {
  Chart chart;
  chart.title = fmt::format("{}, σ {} texels, roughness {}", cell.surface, cell.sigma_texels, cell.roughness);
  chart.x_label = "queries a second →";
  chart.y_label = "relative L2 error";
  chart.pareto = true;
  for (const Measurement& m : cell.measurements) {
    if (!m.refused.empty()) continue;
    if (chart.series.empty() || chart.series.back().evaluator != m.evaluator)
      chart.series.push_back({m.evaluator, {}, true, true});
    chart.series.back().points.push_back(
        {m.speed.median, std::max(m.errors.relative_l2, kLeastError), m.knob, tooltip(m)});
  }
  return draw(chart);
}

/// A value of each evaluator's measurements over the cells: first knob only.
template <typename X, typename Y>
std::vector<ChartSeries> series_over(const std::vector<const Cell*>& cells, X x, Y y) {
  std::vector<ChartSeries> all;
  for (const Cell* cell : cells) {
    for (const Measurement& m : cell->measurements) {
      if (!m.refused.empty() || !(m.knob.empty() || m.knob == "1")) continue;
      auto series = std::find_if(all.begin(), all.end(),
                                 [&](const ChartSeries& s) { return s.evaluator == m.evaluator; });
      if (series == all.end()) series = all.insert(all.end(), {m.evaluator, {}, true});
      series->points.push_back({x(*cell), y(m), "", tooltip(m)});
    }
  }
  return all;
}

std::string cost_against_footprint(const Results& results) {
  std::string html =
      "<h2>Cost against footprint</h2>\n" +
      paragraph(
          "Microseconds a query while the footprint grows, on the same maps. A flat line costs the "
          "same at any footprint. Mixtures have one element a texel and axis here.") +
      "<div class=\"row\">";
  for (std::size_t first = 0; first < results.cells.size();) {
    std::size_t end = first;
    std::vector<const Cell*> cells;
    for (; end < results.cells.size() && results.cells[end].surface == results.cells[first].surface; ++end)
      if (results.cells[end].roughness == results.cells[first].roughness)
        cells.push_back(&results.cells[end]);
    Chart chart;
    chart.title = fmt::format("{}, {}² texels, roughness {}", cells[0]->surface, cells[0]->resolution,
                              cells[0]->roughness);
    chart.x_label = "footprint σ, texels", chart.y_label = "µs a query";
    chart.series = series_over(
        cells, [](const Cell& c) { return c.sigma_texels; },
        [](const Measurement& m) { return 1e6 / m.speed.median; });
    html += draw(chart);
    first = end;
  }
  if (!results.grid.empty()) {
    Chart chart;
    chart.title = "grid, which has no map";
    chart.x_label = "footprint σ, cells", chart.y_label = "µs a query";
    chart.series = {{"grid", {}, true}};
    for (const bench::GridPoint& point : results.grid)
      chart.series[0].points.push_back(
          {point.cells_a_footprint, 1e6 / point.speed.median, "",
           fmt::format("{}, relative L2 against its definition {}", rate(point.speed.median),
                       percent(point.errors.relative_l2))});
    html += draw(chart);
  }
  return html + "</div>\n";
}

std::string cost_against_map(const Results& results) {
  std::vector<const Cell*> cells;
  for (const Cell& cell : results.map_sizes) cells.push_back(&cell);
  if (cells.empty()) return "";
  const auto size = [](const Cell& c) { return static_cast<double>(c.resolution); };
  Chart speed, build;
  speed.title = fmt::format("{}, footprint σ {} texels", cells[0]->surface, cells[0]->sigma_texels);
  speed.x_label = build.x_label = "map side, texels", speed.y_label = "µs a query";
  speed.series = series_over(cells, size, [](const Measurement& m) { return 1e6 / m.speed.median; });
  build.title = "Building the structure", build.y_label = "seconds";
  build.series =
      series_over(cells, size, [](const Measurement& m) { return std::max(m.build_seconds, 1e-4); });
  return "<h2>Cost against map size</h2>\n" +
         paragraph(
             "The same footprints on maps of several sizes: what a query costs, and what has to be built "
             "first.") +
         "<div class=\"row\">" + draw(speed) + draw(build) + "</div>\n";
}

std::string memory(const Results& results) {
  if (results.cells.empty()) return "";
  const Cell& cell = results.cells.front();
  std::vector<Bar> bars;
  for (const Measurement& m : cell.measurements)
    if (m.refused.empty())
      bars.push_back({m.evaluator, m.label, mebibytes(m.device_bytes), static_cast<double>(m.device_bytes)});
  return "<h2>Memory</h2>\n" +
         paragraph(fmt::format("Bytes on the device for a map of {}² texels ({}).", cell.resolution,
                               cell.surface)) +
         draw_bars(bars);
}

std::string figure(const std::string& image, const std::string& caption) {
  return "<figure>" + image + "<figcaption>" + caption + "</figcaption></figure>\n";
}

std::string thumbnails(const Results& results) {
  std::string html =
      "<h2>What they see</h2>\n" +
      paragraph(
          "One footprint's P-NDF: half vectors over a window of the disk, brightness by the square "
          "root of density. Below each its difference from the reference: orange where it is too "
          "bright, blue where it is too dark, full colour at 5 % of the reference's peak.");
  for (const bench::ThumbnailRow& row : results.thumbnails) {
    const std::vector<float>& reference = row.thumbnails.front().densities;
    const double peak = *std::max_element(reference.begin(), reference.end());
    html +=
        fmt::format("<h3>{}, footprint σ {} texels, roughness {}, window ±{:.2f}</h3>\n<div class=\"row\">",
                    row.surface, row.sigma_texels, row.roughness, row.window);
    for (const bench::Thumbnail& t : row.thumbnails) {
      const int zoom = std::max(1, 128 / t.side);
      std::string images = image_tag(t.side, t.side, grey_pixels(t.densities, peak), zoom, t.label);
      if (&t != &row.thumbnails.front())
        images += image_tag(t.side, t.side, difference_pixels(t.densities, reference, 0.05 * peak), zoom,
                            "difference of " + t.label);
      html +=
          figure(images, escape_markup(t.label) + (&t == &row.thumbnails.front()
                                                       ? std::string(" (double precision)")
                                                       : fmt::format("<br>L2 {}", percent(t.relative_l2))));
    }
    html += "</div>\n";
  }
  return html;
}

std::string caption_of(const Picture& picture) {
  return fmt::format("{}<br>{}, relMSE {:.2g}<br>ΔE₀₀ {:.2g}, 95 % {:.2g}", escape_markup(picture.label),
                     duration(picture.seconds), picture.relative_mse, picture.delta_e_mean,
                     picture.delta_e_percentile_95);
}

std::string pictures(const Results& results) {
  if (results.pictures.empty()) return "";
  const int zoom = std::max(1, 216 / results.reference_picture.width);
  std::string html =
      "<h2>Pictures</h2>\n" +
      paragraph(
          escape_markup(results.picture_text) +
          ". Each evaluator stands beside brute force (point samples of the map under each footprint, on the "
          "host's processors) that had <em>equal time</em>, and beside brute force of <em>equal error</em>, "
          "as far "
          "as a few seconds reach: the caption says how many samples a footprint and how long it would take. "
          "Errors are against the double-precision reference picture: relMSE is the mean of (x − ref)² / "
          "(ref² + "
          "0.01) of linear values, ΔE₀₀ the CIEDE2000 colour difference of the pictures as displayed, its "
          "mean and "
          "95th percentile over pixels: 1 can just be seen, 100 is black to white.") +
      "<div class=\"row\">" +
      figure(picture_tag(results.reference_picture, zoom, "reference"), "reference, double precision") +
      "</div>\n";
  for (const PictureRow& row : results.pictures) {
    html += "<h3>" + escape_markup(row.evaluator.label) + "</h3>\n<div class=\"row\">";
    html += figure(picture_tag(row.evaluator.image, zoom, row.evaluator.label), caption_of(row.evaluator));
    html += figure(picture_tag(row.equal_time.image, zoom, "equal time"),
                   "equal time: " + caption_of(row.equal_time));
    const std::string needed = fmt::format("<br>{} the evaluator's error: {:.2g} samples, {}",
                                           row.equal_error_capped ? "would reach" : "reaches",
                                           row.equal_error_samples, duration(row.equal_error_seconds));
    html += figure(picture_tag(row.equal_error.image, zoom, "equal error"),
                   (row.equal_error_capped ? "towards equal error: " : "equal error: ") +
                       caption_of(row.equal_error) + needed);
    html += "</div>\n";
  }
  return html;
}

std::string table(const Results& results) {
  std::string html =
      "<h2>All numbers</h2>\n<details><summary>Show the "
      "table</summary>\n<table><tr><th>surface</th><th>footprint σ</th>"
      "<th>roughness</th><th>evaluator</th><th>queries/s</th><th>spread</th><th>relative L2</th><th>99 "
      "%</th><th>maximum</th>"
      "<th>build</th><th>memory</th><th>of FMA peak</th><th>of bandwidth ≥</th></tr>\n";
  for (const Cell& cell : results.cells) {
    for (const Measurement& m : cell.measurements) {
      html += fmt::format("<tr><td>{}</td><td class=n>{}</td><td class=n>{}</td><td>{}</td>", cell.surface,
                          cell.sigma_texels, cell.roughness, escape_markup(m.label));
      if (!m.refused.empty()) {
        html += fmt::format("<td colspan=9>refused: {}</td></tr>\n", escape_markup(m.refused));
        continue;
      }
      const auto share = [](double value) { return value < 0 ? std::string("–") : percent(value); };
      html += fmt::format(
          "<td class=n>{}</td><td class=n>{} – {}</td><td class=n>{}</td><td class=n>{}</td><td "
          "class=n>{}</td>"
          "<td class=n>{}</td><td class=n>{}</td><td class=n>{}</td><td class=n>{}</td></tr>\n",
          rate(m.speed.median), rate(m.speed.slowest), rate(m.speed.fastest), percent(m.errors.relative_l2),
          percent(m.errors.percentile_99), percent(m.errors.maximum), duration(m.build_seconds),
          mebibytes(m.device_bytes), share(m.share_of_peak), share(m.share_of_bandwidth));
    }
  }
  return html + "</table></details>\n";
}

std::string introduction(const Results& results) {
  std::string html = fmt::format(
      "<h1>Speed against error</h1>\n<p class=\"facts\">Mica {}, suite {}, {}, {} ({} compute "
      "units), {:.0f} s</p>\n",
      version(), results.suite, results.started, escape_markup(results.device.name),
      results.device.compute_units, results.seconds);
  html += paragraph(
      "A <em>query</em> asks for the density of normals at one half vector under one pixel's footprint, a "
      "Gaussian in the "
      "texture. Every evaluator answered the same queries on the same normal maps in this run, so compare "
      "them with each "
      "other rather than with another run on another day.");
  html +=
      paragraph(fmt::format("<b>Speed</b>: wall-clock time of whole calls with all transfers, the median of "
                            "{} repeats after a warm-up, on "
                            "65,536 neighbouring footprints (fewer for slow evaluators) whose half vector "
                            "turns slowly, as at the edge of a "
                            "highlight. <b>Error</b>: against the integral over the same surface in double "
                            "precision: relative L2 = "
                            "√(Σ(D − ref)² / Σref²) over up to 1024 of those queries; in the table also the "
                            "99th percentile and the maximum of "
                            "|D − ref| / (ref + peak / 100). Errors below 10⁻⁷ are drawn there.",
                            results.cells.empty() || results.cells[0].measurements.empty()
                                ? 0
                                : results.cells[0].measurements[0].speed.repeats));
  html +=
      paragraph(fmt::format("The device reached <b>{:.0f} GFLOP/s</b> in a chain of multiply-adds and moved "
                            "<b>{:.1f} GB/s</b> in a triad, "
                            "measured in this run; shares in the table are of these. The share of bandwidth "
                            "counts what has to be moved at the "
                            "least (queries, densities, and each part of the structure once).",
                            1e-9 * results.fma_peak, 1e-9 * results.bandwidth));
  return html;
}

}  // namespace

std::string bench_page(const bench::Results& results) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Mica: speed against "
      "error</title>\n<style>" +
      std::string(kStyle) + "</style></head>\n<body>\n" + introduction(results);
  html +=
      "<h2>Speed against error</h2>\n" +
      paragraph(
          "Each mark is an evaluator; right is faster, lower is closer. The grey band is the Pareto front: "
          "nothing measured is both faster and closer than what lies on it. Numbers beside a mark are the "
          "elements a texel and axis of a mixture, or the tolerance asked for. Rest the pointer on a mark "
          "for its numbers.") +
      draw_legend(evaluators_of(results)) + "<div class=\"row\">";
  for (const Cell& cell : results.cells) html += scatter(cell);
  html += "</div>\n" + tolerance_charts(results) + cost_against_footprint(results) +
          cost_against_map(results) + memory(results) + thumbnails(results) + pictures(results) +
          table(results);
  return html + "</body></html>\n";
}

}  // namespace mica::host
