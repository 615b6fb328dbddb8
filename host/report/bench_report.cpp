#include "host/report/bench_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/report/tolerance_curves.h"
#include "mica/version.h"

namespace mica::host {
namespace {

using bench::Cell;
using bench::Errors;
using bench::Measurement;
using bench::Picture;
using bench::Speed;
using nlohmann::ordered_json;

ordered_json to_json(const Speed& speed) {
  return {{"median", speed.median},
          {"slowest", speed.slowest},
          {"fastest", speed.fastest},
          {"queries_a_repeat", speed.queries},
          {"repeats", speed.repeats}};
}

ordered_json to_json(const Errors& errors) {
  return {{"relative_l2", errors.relative_l2},
          {"percentile_99", errors.percentile_99},
          {"maximum", errors.maximum}};
}

ordered_json share(double value) {
  return value < 0 ? ordered_json() : ordered_json(value);
}

ordered_json to_json(const Measurement& m) {
  if (!m.refused.empty()) return {{"evaluator", m.evaluator}, {"knob", m.knob}, {"refused", m.refused}};
  return {{"evaluator", m.evaluator},
          {"knob", m.knob},
          {"queries_per_second", to_json(m.speed)},
          {"over_first", m.over_first},
          {"errors", to_json(m.errors)},
          {"build_seconds", m.build_seconds},
          {"device_bytes", m.device_bytes},
          {"share_of_peak", share(m.share_of_peak)},
          {"share_of_bandwidth", share(m.share_of_bandwidth)}};
}

ordered_json to_json(const std::vector<Cell>& cells) {
  ordered_json list = ordered_json::array();
  for (const Cell& cell : cells) {
    ordered_json measurements = ordered_json::array();
    for (const Measurement& m : cell.measurements) measurements.push_back(to_json(m));
    list.push_back({{"surface", cell.surface},
                    {"resolution", cell.resolution},
                    {"sigma_texels", cell.sigma_texels},
                    {"roughness", cell.roughness},
                    {"reference_queries", cell.reference_queries},
                    {"measurements", measurements}});
  }
  return list;
}

/// By the cell's place in the list, and the evaluator.
ordered_json to_json(const ToleranceCurve& curve, const std::vector<Cell>& cells) {
  ordered_json points = ordered_json::array();
  for (const ToleranceCurve::Point& point : curve.points)
    points.push_back({{"tolerance", share(point.measured->tolerance > 0 ? point.measured->tolerance : -1)},
                      {"speed_over_exact", point.speed_ratio},
                      {"relative_l2", point.measured->errors.relative_l2}});
  return {{"cell", curve.cell - cells.data()},
          {"evaluator", curve.points[0].measured->evaluator},
          {"points", points}};
}

ordered_json to_json(const Picture& picture) {
  return {{"label", picture.label},
          {"seconds", picture.seconds},
          {"samples", picture.samples},
          {"relative_mse", picture.relative_mse},
          {"ciede2000_mean", picture.delta_e_mean},
          {"ciede2000_percentile_95", picture.delta_e_percentile_95}};
}

}  // namespace

std::string bench_json(const bench::Results& results) {
  ordered_json json = {
      {"mica", version()},
      {"suite", results.suite},
      {"started", results.started},
      {"seconds", results.seconds},
      {"device", {{"name", results.device.name}, {"compute_units", results.device.compute_units}}},
      {"fma_peak_flops", results.fma_peak},
      {"bandwidth_bytes_per_second", results.bandwidth},
      {"cells", to_json(results.cells)},
      {"map_sizes", to_json(results.map_sizes)}};
  json["tolerance_curves"] = ordered_json::array();
  for (const ToleranceCurve& curve : tolerance_curves(results))
    json["tolerance_curves"].push_back(to_json(curve, results.cells));
  for (const bench::GridPoint& point : results.grid)
    json["grid"].push_back({{"cells_a_footprint", point.cells_a_footprint},
                            {"queries_per_second", to_json(point.speed)},
                            {"errors", to_json(point.errors)}});
  for (const bench::ThumbnailRow& row : results.thumbnails)
    for (const bench::Thumbnail& thumbnail : row.thumbnails)
      json["thumbnails"].push_back(
          {{"surface", row.surface}, {"label", thumbnail.label}, {"relative_l2", thumbnail.relative_l2}});
  for (const bench::PictureRow& row : results.pictures)
    json["pictures"].push_back({{"evaluator", to_json(row.evaluator)},
                                {"equal_time", to_json(row.equal_time)},
                                {"equal_error", to_json(row.equal_error)},
                                {"equal_error_samples", row.equal_error_samples},
                                {"equal_error_seconds", row.equal_error_seconds}});
  return json.dump(2) + "\n";
}

std::string bench_summary(const bench::Results& results) {
  std::string text = fmt::format("device {}, multiply-add peak {:.0f} GFLOP/s, memory {:.1f} GB/s\n",
                                 results.device.name, 1e-9 * results.fma_peak, 1e-9 * results.bandwidth);
  text += fmt::format("{:<10} {:>6} {:>9} {:<32} {:>12} {:>11} {:>10} {:>8} {:>8}\n", "surface", "sigma",
                      "roughness", "evaluator", "queries/s", "relative L2", "99%", "MiB", "of peak");
  for (const Cell& cell : results.cells) {
    for (const Measurement& m : cell.measurements) {
      text +=
          fmt::format("{:<10} {:>6} {:>9} {:<32} ", cell.surface, cell.sigma_texels, cell.roughness, m.label);
      if (!m.refused.empty())
        text += fmt::format("refused: {}\n", m.refused);
      else
        text += fmt::format("{:>12.4g} {:>11.2e} {:>10.2e} {:>8.1f} {:>8}\n", m.speed.median,
                            m.errors.relative_l2, m.errors.percentile_99,
                            static_cast<double>(m.device_bytes) / (1 << 20),
                            m.share_of_peak < 0 ? "-" : fmt::format("{:.1f}%", 100 * m.share_of_peak));
    }
  }
  return text + tolerance_summary(results);
}

}  // namespace mica::host
