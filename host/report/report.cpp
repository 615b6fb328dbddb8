#include "host/report/report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "mica/version.h"

namespace mica::host {
namespace {

using nlohmann::ordered_json;

double to_mebibytes(std::size_t bytes) {
  return static_cast<double>(bytes) / (1 << 20);
}

double queries_per_second(std::size_t queries, double seconds) {
  return seconds > 0 ? static_cast<double>(queries) / seconds : 0;
}

ordered_json to_json(const Plan& plan) {
  ordered_json evaluators = ordered_json::array();
  for (const PlannedEvaluator& e : plan.evaluators) {
    evaluators.push_back({{"surface", e.surface},
                          {"evaluator", e.evaluator},
                          {"width", e.width},
                          {"height", e.height},
                          {"kernel", e.kernel},
                          {"materials", e.materials},
                          {"host_bytes", e.host_bytes},
                          {"device_bytes", e.device_bytes}});
  }
  return {{"evaluators", evaluators},
          {"channels", plan.channels},
          {"gathers_light", plan.gathers_light},
          {"samples", plan.samples},
          {"rows_a_block", plan.rows_a_block},
          {"queries_a_batch", plan.queries_a_batch},
          {"host_bytes", plan.host_bytes},
          {"device_bytes", plan.device_bytes}};
}

ordered_json to_json(const Job& job) {
  return {{"path", job.path}, {"hash", fmt::format("{:016x}", job.hash)}, {"seed", job.seed}};
}

ordered_json to_json(const DeviceInfo& device) {
  return {{"name", device.name},
          {"platform", device.platform},
          {"version", device.version},
          {"driver", device.driver},
          {"compute_units", device.compute_units}};
}

}  // namespace

std::string plan_json(const Job& job, const Plan& plan, const std::optional<Estimate>& estimate) {
  ordered_json json = {{"mica", version()}, {"job", to_json(job)}, {"plan", to_json(plan)}};
  if (job.frames.given) json["frames"] = {job.frames.first, job.frames.last};
  if (estimate)
    json["estimate"] = {{"queries", estimate->queries},
                        {"seconds", estimate->seconds},
                        {"device_bytes", estimate->device_bytes}};
  return json.dump(2) + "\n";
}

std::string render_json(const Job& job, const DeviceInfo& device, const RenderResult& result) {
  const PhaseSeconds& s = result.seconds;
  ordered_json json;
  json["mica"] = version();
  json["job"] = to_json(job);
  json["frame"] = result.frame;
  json["device"] = to_json(device);
  json["plan"] = to_json(result.plan);
  json["device_bytes"] = result.device_bytes;
  json["seconds"] = {{"surfaces", s.surfaces}, {"scene", s.scene}, {"build", s.build},
                     {"render", s.render},     {"trace", s.trace}, {"gather", s.gather},
                     {"refine", s.refine},     {"wait", s.wait},   {"audit", s.audit},
                     {"total", s.total}};
  json["queries"] = result.queries;
  json["dropped_queries"] = result.dropped_queries;
  json["refined_pixels"] = result.refined_pixels;
  json["lamps_error"] = result.lamps_error;
  json["device_seconds"] = result.device_seconds;
  json["queries_per_second"] = queries_per_second(result.queries, s.render);
  json["device_queries_per_second"] = queries_per_second(result.queries, result.device_seconds);
  json["audit"] = {{"samples", result.audit.samples},
                   {"relative_l2", result.audit.relative_l2},
                   {"percentile_99", result.audit.percentile_99},
                   {"maximum", result.audit.maximum},
                   {"precision", result.precision_error}};
  json["picture_audit"] = {{"pixels", result.picture_audit.pixels},
                           {"relative_l2", result.picture_audit.relative_l2},
                           {"upper_bound", result.picture_audit.upper_bound},
                           {"reference_subpixels", result.picture_audit.subpixels},
                           {"reference_l2", result.picture_audit.reference_l2},
                           {"of_densities", result.picture_audit.of_densities},
                           {"of_footprints", result.picture_audit.of_footprints},
                           {"of_lamps", result.picture_audit.of_lamps}};
  json["repairs"] = {{"not_finite", result.repairs.not_finite},
                     {"negative", result.repairs.negative},
                     {"replaced_answers", result.replaced_answers}};
  json["notes"] = result.surface_notes;
  json["warnings"] = result.surface_warnings;
  return json.dump(2) + "\n";
}

std::string failure_json(int frame, const std::string& error) {
  // Paths need not be UTF-8; JSON has to be.
  const ordered_json json = {{"frame", frame}, {"error", error}};
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string skipped_json(int frame) {
  return ordered_json{{"frame", frame}, {"skipped", true}}.dump(2) + "\n";
}

std::string frames_json(const std::vector<std::string>& frames) {
  ordered_json all = ordered_json::array();
  for (const std::string& frame : frames) all.push_back(ordered_json::parse(frame));
  return ordered_json{{"frames", all}}.dump(2) + "\n";
}

std::string render_summary(const DeviceInfo& device, const RenderResult& result) {
  const PhaseSeconds& s = result.seconds;
  std::string text = fmt::format("device    {} ({} compute units)\n", device.name, device.compute_units);
  text +=
      fmt::format("memory    {:.1f} MiB of structures on the device\n", to_mebibytes(result.device_bytes));
  text += fmt::format(
      "seconds   {:.2f} in all: surfaces {:.2f}, scene {:.2f}, build {:.2f}, render {:.2f} (of it tracing "
      "{:.2f}, gathering light {:.2f}, waiting for the device {:.2f}), audit {:.2f}\n",
      s.total, s.surfaces, s.scene, s.build, s.render, s.trace, s.gather, s.wait, s.audit);
  text += fmt::format("queries   {} at {:.3f} million/s ({:.3f} in the kernels alone)\n", result.queries,
                      1e-6 * queries_per_second(result.queries, s.render),
                      1e-6 * queries_per_second(result.queries, result.device_seconds));
  if (result.audit.samples) {
    text += fmt::format(
        "audit     {} queries against the oracle: relative L2 {:.2e}, 99th percentile {:.2e}, "
        "maximum {:.2e}\n",
        result.audit.samples, result.audit.relative_l2, result.audit.percentile_99, result.audit.maximum);
  }
  if (result.picture_audit.pixels)
    text += fmt::format(
        "picture   {} pixels integrated again: relative L2 {:.2e}, at most {:.2e} at 95% confidence ({}x{} "
        "footprints each, within {:.1e} of half as many a side); of densities {:.1e}, of footprints {:.1e}, "
        "of "
        "lamps' extent {:.1e}\n",
        result.picture_audit.pixels, result.picture_audit.relative_l2, result.picture_audit.upper_bound,
        result.picture_audit.subpixels, result.picture_audit.subpixels, result.picture_audit.reference_l2,
        result.picture_audit.of_densities, result.picture_audit.of_footprints, result.picture_audit.of_lamps);
  return text;
}

}  // namespace mica::host
