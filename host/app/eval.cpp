// mica eval: densities of a table of queries.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/app/commands.h"
#include "host/app/eval_patch.h"
#include "host/app/evaluation.h"
#include "host/app/grid_options.h"
#include "host/app/json_file.h"
#include "host/app/map_options.h"
#include "host/app/output.h"
#include "host/image/image.h"
#include "host/methods/cavities/cavity_brdf.h"
#include "host/methods/make_patch_brdf.h"
#include "host/methods/map/map_query.h"
#include "host/tables/query_table.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

using Clock = std::chrono::steady_clock;

struct EvalOptions {
  MapOptions map;
  GridOptions grid;
  std::string quantity = "ndf", ndf, queries, output, json;
  std::string masking = "exact", part = "all", compensation = "diffuse", energy = "exact";
  std::optional<double> roughness, tolerance;
  int device = 0, elements = 1;
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

/// What is evaluated: glints on a grid, or a surface, which has to outlive its evaluator.
struct Subject {
  bool is_grid = false;
  GlintGrid grid;
  std::optional<Surface> surface;
  SurfaceReport report;
};

Subject load_subject(const EvalOptions& options) {
  Subject subject;
  subject.is_grid = options.ndf == "grid";
  if (subject.is_grid) {
    subject.grid = to_glint_grid(options.grid);
  } else {
    if (options.map.path.empty()) throw UsageError(fmt::format("--ndf {} needs a --map", options.ndf));
    subject.surface = load_map(options.map, &subject.report);
  }
  return subject;
}

nlohmann::json describe(const EvalOptions& options, const Subject& subject) {
  if (subject.is_grid)
    return {{"distribution", options.grid.distribution},
            {"alpha", {subject.grid.alpha_x, subject.grid.alpha_y}},
            {"density", subject.grid.density},
            {"stretch", subject.grid.stretch},
            {"seed", subject.grid.seed}};
  return {{"file", options.map.path},
          {"width", subject.surface->width()},
          {"height", subject.surface->height()},
          {"interpolation", options.map.interpolation},
          {"notes", subject.report.notes},
          {"warnings", subject.report.warnings}};
}

nlohmann::json summary(const EvalOptions& options, const Subject& subject, const OpenEvaluator& open,
                       std::size_t count, const PhaseTimes& times) {
  nlohmann::json json;
  json["command"] = "eval";
  json["quantity"] = options.quantity;
  json[subject.is_grid ? "glints" : "map"] = describe(options, subject);
  json["evaluator"] = open.evaluator->name();
  if (options.tolerance) json["tolerance"] = *options.tolerance;
  if (nlohmann::json choices = describe_choices(open); !choices.empty()) json["auto"] = std::move(choices);
  json["device"] = open.device ? describe_device(open.device->info()) : nlohmann::json();
  json["device_bytes"] = open.evaluator->device_bytes();
  json["seconds"] = {
      {"load", times.load}, {"build", times.build}, {"evaluate", times.evaluate}, {"device", times.device}};
  json["queries"] = count;
  json["queries_per_second"] = times.evaluate > 0 ? static_cast<double>(count) / times.evaluate : 0.0;
  json["output"] = options.output;
  return json;
}

QueryTable read_queries(const EvalOptions& options) {
  if (options.ndf == "grid")
    return QueryTable(options.queries, options.grid.microroughness, "--microroughness");
  return QueryTable(options.queries, options.roughness);
}

int run_patches(const EvalOptions& options) {
  if (options.tolerance) throw UsageError("--tolerance is for --quantity ndf");
  PatchEvaluation patches = {options.map,          options.quantity,  options.ndf,     options.queries,
                             options.output,       options.json,      options.masking, options.part,
                             options.roughness,    options.grid.seed, options.device,  options.elements,
                             options.compensation, options.energy};
  if (options.ndf == "grid") {
    patches.glints = to_glints_description(options.grid);
    patches.roughness = options.grid.microroughness;
  }
  return evaluate_patches(patches);
}

int run(const EvalOptions& options) {
  if (options.quantity != "ndf") return run_patches(options);
  if (options.ndf == "cavities")
    throw UsageError(
        "--ndf cavities answers --quantity brdf, energy and sample; two normals a point are no P-NDF");
  check_tolerance(options.ndf, options.tolerance);
  check_extension(options.output, {".npy"});
  prepare_output(options.output);
  if (!options.json.empty()) prepare_output(options.json);

  PhaseTimes times;
  Clock::time_point start = Clock::now();
  const QueryTable table = read_queries(options);
  const Subject subject = load_subject(options);
  table.check([&](const Query& query) {
    return subject.is_grid ? grid_query_problem(query)
                           : query_problem(query, subject.surface->width(), subject.surface->height());
  });
  times.load = lap(&start);
  const OpenEvaluator open = subject.is_grid ? open_grid(subject.grid, options.device)
                                             : open_evaluator(options.ndf, options.tolerance, options.device,
                                                              *subject.surface, options.elements);
  if (!subject.is_grid)
    calibrate(open, *subject.surface, table.size(), [&](std::size_t row) { return table.query(row); });
  times.build = lap(&start);
  const std::vector<float> densities =
      evaluate_all(open.evaluator.get(), table.size(), [&](std::size_t row) { return table.query(row); });
  times.evaluate = lap(&start);
  times.device = open.evaluator->device_seconds();

  write_file_atomically(options.output, to_npy(densities));
  spdlog::info("{} queries by {} on {} in {:.3g} s", densities.size(), open.evaluator->name(),
               open.device ? open.device->info().name : "the host", times.evaluate);
  if (!options.json.empty())
    write_json(options.json, summary(options, subject, open, densities.size(), times));
  return 0;
}

std::vector<std::string> evaluator_choices() {
  std::vector<std::string> names = ndf_names();
  names.insert(names.end(), {"grid", "cavities"});
  return names;
}

void add_patch_options(CLI::App* command, EvalOptions* options) {
  std::vector<std::string> quantities = patch_quantities();
  quantities.insert(quantities.begin(), "ndf");
  command->add_option("--quantity", options->quantity, "What is evaluated")
      ->type_name("NAME")
      ->check(CLI::IsMember(quantities))
      ->capture_default_str();
  command
      ->add_option("--masking", options->masking,
                   "Of a BRDF: of every lobe under the footprint, of one lobe with their moments, or of the "
                   "map's roughness")
      ->type_name("NAME")
      ->check(CLI::IsMember(masking_names()))
      ->capture_default_str();
  command
      ->add_option("--energy", options->energy,
                   "Of cavities, what one bounce loses: of every seed under the footprint, or by a table of "
                   "roughness and angle")
      ->type_name("NAME")
      ->check(CLI::IsMember(lost_energy_names()))
      ->capture_default_str();
  command
      ->add_option("--compensation", options->compensation,
                   "Of cavities, where light goes that bounces more than once")
      ->type_name("NAME")
      ->check(CLI::IsMember(compensation_names()))
      ->capture_default_str();
  command->add_option("--part", options->part, "Light that bounced once, more often, or both")
      ->type_name("NAME")
      ->check(CLI::IsMember(std::vector<std::string>{"single", "multiple", "all"}))
      ->capture_default_str();
}

}  // namespace

void add_eval(CLI::App& app, Command* chosen) {
  auto options = std::make_shared<EvalOptions>();
  CLI::App* command = app.add_subcommand("eval", "Evaluates a table of queries: the batch engine bare");
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
      "Turns and lobes that are not round are refused by beckmanns and grid.\n"
      "With --ndf grid, uv is that of its --density, and roughness the --microroughness of one glint.\n"
      "Output: D, the density of normals over the unit disk at (s, t), float32, shape (rows,).\n"
      "A row that cannot be evaluated is named, and nothing is written.\n"
      "Other quantities, of evaluators with a BRDF of their own, have directions in place of s t, of any\n"
      "length but 0, z along the geometric normal g; below the horizon nothing is seen and all is 0:\n"
      "  brdf    u v cuu cuv cvv ox oy oz ix iy iz [roughness] -> f(o, i) max(i.g, 0), without Fresnel\n"
      "  energy  u v cuu cuv cvv ox oy oz [roughness] -> what a white patch scatters at once, and what it "
      "loses\n"
      "  sample  u v cuu cuv cvv ox oy oz [roughness] -> ix iy iz pdf weight; pdf 0: nothing was drawn");
  add_map_options(command, &options->map);
  add_grid_options(command, &options->grid);
  add_patch_options(command, options.get());
  command->add_option("--ndf", options->ndf, "Evaluator; reference is the host in double precision")
      ->required()
      ->type_name("NAME")
      ->check(CLI::IsMember(evaluator_choices()));
  command
      ->add_option("--roughness", options->roughness,
                   "Of all rows, 1e-5 to 1; a Beckmann alpha is sqrt(2) times this")
      ->type_name("SIGMA");
  command
      ->add_option("--tolerance", options->tolerance,
                   "Relative error allowed: auto keeps it as relative L2 (default 0.01), triangles keeps "
                   "1e-4, reference "
                   "takes 1e-12 to 0.1")
      ->type_name("ERROR");
  command->add_option("--queries", options->queries, "Table of queries, .npy or .csv")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", options->output, "Densities, .npy")->required()->type_name("FILE");
  command
      ->add_option("--json", options->json,
                   "Writes what was done: map, device, bytes, seconds, queries a second")
      ->type_name("FILE");
  command
      ->add_option("--elements", options->elements,
                   "Elements of a mixture, or seeds of cavities, a texel and axis: more are slower and "
                   "closer to the map")
      ->type_name("N")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  command->add_option("--device", options->device, "OpenCL device, by its number in `mica devices`")
      ->type_name("N")
      ->capture_default_str();
  command->callback([options, chosen] { *chosen = [options] { return run(*options); }; });
}

}  // namespace mica::host::app
