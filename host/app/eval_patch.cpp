// mica eval --quantity brdf, energy and sample: what a patch BRDF answers to a table of queries.
#include "host/app/eval_patch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/app/evaluation.h"
#include "host/app/json_file.h"
#include "host/app/output.h"
#include "host/base/stopwatch.h"
#include "host/image/image.h"
#include "host/methods/cavities/cavity_brdf.h"
#include "host/methods/grid/grid_brdf.h"
#include "host/methods/make_patch_brdf.h"
#include "host/tables/patch_table.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

PatchQuantity to_quantity(const std::string& name) {
  if (name == "energy") return PatchQuantity::energy;
  return name == "sample" ? PatchQuantity::sample : PatchQuantity::brdf;
}

PatchBrdfSettings to_settings(const PatchEvaluation& options) {
  PatchBrdfSettings settings;
  const auto index = [](const std::vector<std::string>& names, const std::string& name) {
    return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  settings.masking = static_cast<Masking>(index(masking_names(), options.masking));
  settings.compensation = static_cast<Compensation>(index(compensation_names(), options.compensation));
  settings.energy = static_cast<LostEnergy>(index(lost_energy_names(), options.energy));
  settings.elements = options.elements;
  return settings;
}

float chosen_part(const std::string& part, float single, float multiple) {
  if (part == "single") return single;
  return part == "multiple" ? multiple : single + multiple;
}

/// The answers, row by row, and how many there are in one.
struct Answers {
  std::vector<float> values;
  std::size_t columns = 0;  // 0: one number a row
};

/// Queries of `count` rows from `first`, answered.
template <typename Query, typename Result>
std::vector<Result> ask(PatchBrdf* brdf, std::vector<Result> (PatchBrdf::*answer)(const std::vector<Query>&),
                        std::size_t first, std::size_t count,
                        const std::function<Query(std::size_t)>& query) {
  std::vector<Query> queries(count);
  for (std::size_t n = 0; n < count; ++n) queries[n] = query(first + n);
  return (brdf->*answer)(queries);
}

Answers answer_all(const PatchEvaluation& options, const PatchTable& table, PatchBrdf* brdf) {
  Answers answers;
  std::vector<float>& values = answers.values;
  const std::string& part = options.part;
  const auto brdf_rows = [&](std::size_t first, std::size_t count) {
    for (const BrdfValue& value : ask<BrdfQuery, BrdfValue>(brdf, &PatchBrdf::evaluate, first, count,
                                                            [&](std::size_t row) { return table.brdf(row); }))
      values.push_back(chosen_part(part, value.single, value.multiple));
  };
  const auto energy_rows = [&](std::size_t first, std::size_t count) {
    for (const Albedo& albedo : ask<ViewQuery, Albedo>(brdf, &PatchBrdf::energy, first, count,
                                                       [&](std::size_t row) { return table.view(row); }))
      values.insert(values.end(), {albedo.single, albedo.lost});
  };
  const auto sample_rows = [&](std::size_t first, std::size_t count) {
    for (const BrdfSample& sample :
         ask<SampleQuery, BrdfSample>(brdf, &PatchBrdf::sample, first, count,
                                      [&](std::size_t row) { return table.sample(row, options.seed); }))
      values.insert(values.end(), {sample.light.x(), sample.light.y(), sample.light.z(), sample.pdf,
                                   chosen_part(part, sample.weight_single, sample.weight_multiple)});
  };
  switch (to_quantity(options.quantity)) {
    case PatchQuantity::brdf:
      work_in_chunks(table.size(), brdf_rows);
      break;
    case PatchQuantity::energy:
      answers.columns = 2;
      work_in_chunks(table.size(), energy_rows);
      break;
    case PatchQuantity::sample:
      answers.columns = 5;
      work_in_chunks(table.size(), sample_rows);
      break;
  }
  return answers;
}

}  // namespace

const std::vector<std::string>& patch_quantities() {
  static const std::vector<std::string> names = {"brdf", "energy", "sample"};
  return names;
}

namespace {

/// What is asked: a map, which has to outlive its BRDF, or glints without one.
struct Patch {
  std::optional<Surface> surface;
  nlohmann::json description;

  std::string problem(const ViewQuery& query) const {
    if (surface) return view_problem(query, surface->width(), surface->height());
    return grid_query_problem({query.footprint, Eigen::Vector2d::Zero(), query.roughness});
  }
};

Patch load_patch(const PatchEvaluation& options) {
  if (options.glints)
    return {std::nullopt,
            {{"alpha", {options.glints->alpha.x(), options.glints->alpha.y()}},
             {"density", options.glints->density},
             {"stretch", options.glints->stretch}}};
  SurfaceReport report;
  Surface surface = load_map(options.map, &report);
  const nlohmann::json description = {
      {"file", options.map.path},   {"width", surface.width()},
      {"height", surface.height()}, {"interpolation", options.map.interpolation},
      {"notes", report.notes},      {"warnings", report.warnings}};
  return {std::move(surface), description};
}

std::unique_ptr<PatchBrdf> make_brdf(const PatchEvaluation& options, const Patch& patch, Device& device) {
  if (options.glints) return std::make_unique<GridBrdf>(device, *options.glints);
  return make_patch_brdf(options.ndf, device, *patch.surface, to_settings(options));
}

}  // namespace

int evaluate_patches(const PatchEvaluation& options) {
  std::vector<std::string> names = patch_brdf_names();
  names.emplace_back("grid");
  if (std::find(names.begin(), names.end(), options.ndf) == names.end())
    throw UsageError(fmt::format("--quantity {}: {} has no BRDF of its own; available: {}", options.quantity,
                                 options.ndf, fmt::join(names, ", ")));
  if (!options.glints && options.map.path.empty())
    throw UsageError(fmt::format("--ndf {} needs a --map", options.ndf));
  check_extension(options.output, {".npy"});
  prepare_output(options.output);
  if (!options.json.empty()) prepare_output(options.json);

  const Stopwatch loading;
  const PatchTable table(options.queries, to_quantity(options.quantity), options.roughness);
  const Patch patch = load_patch(options);
  table.check([&](const ViewQuery& query) { return patch.problem(query); });
  const double load_seconds = loading.seconds();
  const Stopwatch building;
  Device device(options.device);
  const std::unique_ptr<PatchBrdf> brdf = make_brdf(options, patch, device);
  const double build_seconds = building.seconds();
  const Stopwatch evaluating;
  const Answers answers = answer_all(options, table, brdf.get());
  const double seconds = evaluating.seconds();

  write_file_atomically(options.output, to_npy(answers.values, answers.columns));
  spdlog::info("{} rows of {} by {} on {} in {:.3g} s", table.size(), options.quantity, brdf->name(),
               device.info().name, seconds);
  if (options.json.empty()) return 0;
  write_json(options.json,
             {{"command", "eval"},
              {"quantity", options.quantity},
              {"evaluator", brdf->name()},
              {"masking", options.masking},
              {"compensation", options.compensation},
              {"energy", options.energy},
              {"part", options.part},
              {"seed", options.seed},
              {options.glints ? "glints" : "map", patch.description},
              {"device", describe_device(device.info())},
              {"device_bytes", brdf->device_bytes()},
              {"seconds",
               {{"load", load_seconds},
                {"build", build_seconds},
                {"evaluate", seconds},
                {"device", brdf->device_seconds()}}},
              {"queries", table.size()},
              {"queries_per_second", seconds > 0 ? static_cast<double>(table.size()) / seconds : 0.0},
              {"output", options.output}});
  return 0;
}

}  // namespace mica::host::app
