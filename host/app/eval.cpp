// mica eval: densities of a table of queries.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/app/commands.h"
#include "host/app/device_option.h"
#include "host/app/eval_output.h"
#include "host/app/eval_patch.h"
#include "host/app/evaluation.h"
#include "host/app/json_file.h"
#include "host/app/map_options.h"
#include "host/app/method_options.h"
#include "host/app/output.h"
#include "host/image/image.h"
#include "host/tables/query_table.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

using Clock = std::chrono::steady_clock;

struct EvalOptions {
  MapOptions map;
  MethodOptions method;
  EvalOutput output;
  std::string quantity = "ndf", queries, json, part = "all";
  std::optional<double> roughness;
  DeviceOption device;
};

struct PhaseTimes {
  double load = 0, build = 0, evaluate = 0, device = 0;  // seconds
};

double lap(Clock::time_point* start) {
  const Clock::time_point now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - *start).count();
  *start = now;
  return seconds;
}

nlohmann::json summary(const EvalOptions& options, const EvalSubject& subject, const OpenEvaluator& open,
                       std::size_t count, const PhaseTimes& times) {
  nlohmann::json json;
  json["command"] = "eval";
  json["quantity"] = options.quantity;
  json[subject.surface ? "map" : "glints"] = subject.description;
  json["evaluator"] = open.evaluator->name();
  if (options.method.tolerance) json["tolerance"] = *options.method.tolerance;
  if (nlohmann::json choices = describe_choices(open); !choices.empty()) json["auto"] = std::move(choices);
  json["device"] = open.device ? describe_device(open.device->info()) : nlohmann::json();
  for (const auto& device : open.further) json["further_devices"].push_back(describe_device(device->info()));
  json["device_bytes"] = open.evaluator->device_bytes();
  json["seconds"] = {
      {"load", times.load}, {"build", times.build}, {"evaluate", times.evaluate}, {"device", times.device}};
  json["queries"] = count;
  json["replaced_answers"] = open.evaluator->replaced();
  json["queries_per_second"] = times.evaluate > 0 ? static_cast<double>(count) / times.evaluate : 0.0;
  json["output"] = options.output.file();
  return json;
}

/// A method's own roughness, where it has one, is the rows' where the table has none.
QueryTable read_queries(const EvalOptions& options, const MethodSettings& settings) {
  if (!settings.own_roughness()) return QueryTable(options.queries, options.roughness);
  const bool given = options.method.given("microroughness");
  return QueryTable(options.queries, given ? settings.own_roughness() : std::nullopt, "--microroughness");
}

ValueFile open_output(const EvalOptions& options, const QueryTable& table) {
  const std::string roughness = options.roughness ? fmt::format("--roughness {}", *options.roughness) : "";
  return options.output.open(
      table.size(), 0,
      options.output.shard.empty()
          ? std::map<std::string, std::string>()
          : answers_identity(table.source(), options.map, options.method, "--quantity ndf " + roughness));
}

double least_roughness(const QueryTable& table, const TableRange& rows) {
  double least = 1;
  for (std::size_t row = rows.first; row < rows.end; ++row)
    least = std::min(least, std::sqrt(lobe_covariance(table.query(row)).diagonal().minCoeff()));
  return least;
}

int run_patches(const EvalOptions& options) {
  if (options.method.tolerance) throw UsageError("--tolerance is for --quantity ndf");
  return evaluate_patches({options.map, options.method, options.output, options.quantity, options.queries,
                           options.json, options.part, options.roughness, options.device});
}

int run(const EvalOptions& options) {
  if (options.quantity != "ndf") return run_patches(options);
  const Method& method = method_of(options.method);
  if (!method.traits().densities)
    throw UsageError(fmt::format("--ndf {} answers --quantity brdf, energy and sample; it has no P-NDF",
                                 options.method.name));
  const std::unique_ptr<MethodSettings> settings = settings_of(options.method);
  const Outputs outputs({options.output.file(), options.json}, {options.map.path, options.queries});

  PhaseTimes times;
  Clock::time_point start = Clock::now();
  const QueryTable table = read_queries(options, *settings);
  const EvalSubject subject = load_subject(options.map, options.method, *settings);
  const TableRange rows = options.output.rows(table.size());
  table.check(rows, [&](const Query& query) { return method.query_problem(query, subject.map()); });
  if (subject.map() != nullptr) log_precision(*subject.map(), least_roughness(table, rows));
  times.load = lap(&start);
  const OpenEvaluator open = open_shared_evaluator(method, *settings, options.device, subject.map());
  open.evaluator->calibrate(
      table.size(), [&](std::size_t row) { return table.query(row); }, 1);
  log_choices(open);
  times.build = lap(&start);
  ValueFile output = open_output(options, table);
  evaluate_all(
      open.evaluator.get(), rows.count(), [&](std::size_t row) { return table.query(rows.first + row); },
      [&](const std::vector<float>& densities) { output.append(densities); });
  times.evaluate = lap(&start);
  times.device = open.evaluator->device_seconds();

  output.finish();
  if (const std::size_t replaced = open.evaluator->replaced())
    spdlog::warn("{} densities were not finite: the oracle's are in their place", replaced);
  spdlog::info("{} queries by {} on {} in {:.3g} s", rows.count(), open.evaluator->name(), device_names(open),
               times.evaluate);
  if (!options.json.empty()) write_json(options.json, summary(options, subject, open, rows.count(), times));
  return 0;
}

void add_patch_options(CommandLine* command, EvalOptions* options) {
  std::vector<std::string> quantities = patch_quantities();
  quantities.insert(quantities.begin(), "ndf");
  command->add_option("--quantity", options->quantity, "What is evaluated")
      .type_name("NAME")
      .check(one_of(quantities))
      .show_default();
  command->add_option("--part", options->part, "Light that bounced once, more often, or both")
      .type_name("NAME")
      .check(one_of(std::vector<std::string>{"single", "multiple", "all"}))
      .show_default();
}

}  // namespace

void add_eval(CommandLine& app, Command* chosen, const MethodRegistry& methods) {
  auto options = std::make_shared<EvalOptions>();
  CommandLine* command = app.add_subcommand("eval", "Evaluates a table of queries: the batch engine bare");
  command->footer(
      "Queries: rows u v cuu cuv cvv s t [roughness] of a float32 or float64 .npy array of shape (rows, 7 or "
      "8),\n"
      "or u v cuu cuv cvv s t rss rst rtt su sv tu tv of shape (rows, 14), or of a .csv file whose first "
      "line "
      "names\n"
      "these columns: any of roughness | rss rst rtt, and su sv tu tv.\n"
      "  u v          mean of the Gaussian footprint, in map periods: the map is [0,1)^2 and repeats\n"
      "  cuu cuv cvv  its covariance, in the same units squared; positive definite\n"
      "  s t          half vector (x, y) on the unit disk, in the map's tangent frame (x along u, y along "
      "v)\n"
      "  roughness    standard deviation of the intrinsic roughness on the disk, 1e-5 to 1; replaces "
      "--roughness\n"
      "  rss rst rtt  covariance of the lobe on the disk in place of a roughness; axes of 1e-5 to 1 "
      "(standard "
      "deviations)\n"
      "  su sv tu tv  turn of the half vector, d(s, t) / d(u, v), a unit of uv: at u it is (s, t) + turn (u "
      "- "
      "mean)\n"
      "Turns and lobes that are not round are refused by beckmanns.\n"
      "With --ndf grid, uv is that of its --density, and roughness or lobe those of one glint.\n"
      "Output: D, the density of normals over the unit disk at (s, t), float32, shape (rows,).\n"
      "A row that cannot be evaluated is named, and nothing is written.\n"
      "Other quantities, of evaluators with a BRDF of their own, have directions in place of s t, of any\n"
      "length but 0, z along the geometric normal g; below the horizon nothing is seen and all is 0:\n"
      "  brdf    u v cuu cuv cvv ox oy oz ix iy iz [roughness] -> f(o, i) times the light's cosine (i.g; "
      "beckmanns: the "
      "patch's own), without Fresnel\n"
      "  energy  u v cuu cuv cvv ox oy oz [roughness] -> what a white patch scatters at once, and what it "
      "loses\n"
      "  sample  u v cuu cuv cvv ox oy oz [roughness] -> ix iy iz pdf weight; pdf 0: nothing was drawn");
  add_map_options(command, &options->map);
  add_patch_options(command, options.get());
  add_method_options(
      command, methods, [](const MethodTraits&) { return true; }, &options->method);
  add_tolerance_option(command, &options->method);
  command
      ->add_option("--roughness", options->roughness,
                   "Of all rows, 1e-5 to 1; a Beckmann alpha is sqrt(2) times this")
      .type_name("SIGMA");
  command->add_option("--queries", options->queries, "Table of queries, .npy or .csv")
      .required()
      .type_name("FILE");
  add_eval_output(command, &options->output);
  command
      ->add_option("--json", options->json,
                   "Writes what was done: map, device, bytes, seconds, queries a second")
      .type_name("FILE");
  add_devices_option(command, &options->device, "the rows of --quantity ndf");
  command->callback([options, chosen] { *chosen = [options] { return run(*options); }; });
}

}  // namespace mica::host::app
