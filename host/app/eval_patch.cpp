// mica eval --quantity brdf, energy and sample: what a patch BRDF answers to a table of queries.
#include "host/app/eval_patch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "host/app/evaluation.h"
#include "host/app/json_file.h"
#include "host/app/output.h"
#include "host/base/stopwatch.h"
#include "host/image/image.h"
#include "host/methods/patch_brdf.h"
#include "host/tables/patch_table.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

PatchQuantity to_quantity(const std::string& name) {
  if (name == "energy") return PatchQuantity::energy;
  return name == "sample" ? PatchQuantity::sample : PatchQuantity::brdf;
}

float chosen_part(const std::string& part, float single, float multiple) {
  if (part == "single") return single;
  return part == "multiple" ? multiple : single + multiple;
}

/// For the draws; the option is a grid's glints' as well.
std::uint64_t seed_of(const PatchEvaluation& options) {
  const std::string text = options.method.text("seed", "1");
  std::uint64_t seed = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size())
    throw UsageError(fmt::format("--seed {}: expected a whole number", text));
  return seed;
}

/// How many numbers an answer is; 0: one a row.
std::size_t columns_of(PatchQuantity quantity) {
  if (quantity == PatchQuantity::energy) return 2;
  return quantity == PatchQuantity::sample ? 5 : 0;
}

/// Queries of `count` rows from `first`, answered.
template <typename Query, typename Result>
std::vector<Result> ask(PatchBrdf* brdf, std::vector<Result> (PatchBrdf::*answer)(const std::vector<Query>&),
                        std::size_t first, std::size_t count,
                        const std::function<Query(std::size_t)>& query) {
  std::vector<Query> queries(count);
  for (std::size_t n = 0; n < count; ++n) queries[n] = query(first + n);
  return (brdf->*answer)(queries);
}

/// The answers to `count` rows from `first`, row by row.
std::vector<float> answer(const PatchEvaluation& options, const PatchTable& table, PatchBrdf* brdf,
                          std::size_t first, std::size_t count) {
  std::vector<float> values;
  const std::string& part = options.part;
  switch (to_quantity(options.quantity)) {
    case PatchQuantity::brdf:
      for (const BrdfValue& value : ask<BrdfQuery, BrdfValue>(
               brdf, &PatchBrdf::evaluate, first, count, [&](std::size_t row) { return table.brdf(row); }))
        values.push_back(chosen_part(part, value.single, value.multiple));
      break;
    case PatchQuantity::energy:
      for (const Albedo& albedo : ask<ViewQuery, Albedo>(brdf, &PatchBrdf::energy, first, count,
                                                         [&](std::size_t row) { return table.view(row); }))
        values.insert(values.end(), {albedo.single, albedo.lost});
      break;
    case PatchQuantity::sample:
      const std::uint64_t seed = seed_of(options);
      for (const BrdfSample& sample :
           ask<SampleQuery, BrdfSample>(brdf, &PatchBrdf::sample, first, count,
                                        [&](std::size_t row) { return table.sample(row, seed); }))
        values.insert(values.end(), {sample.light.x(), sample.light.y(), sample.light.z(), sample.pdf,
                                     chosen_part(part, sample.weight_single, sample.weight_multiple)});
      break;
  }
  return values;
}

ValueFile open_output(const PatchEvaluation& options, const PatchTable& table) {
  std::map<std::string, std::string> identity;
  if (!options.output.shard.empty()) {
    const std::string roughness = options.roughness ? fmt::format("--roughness {}", *options.roughness) : "";
    identity = answers_identity(
        table.source(), options.map, options.method,
        fmt::format("--quantity {} --part {} {}", options.quantity, options.part, roughness));
  }
  return options.output.open(table.size(), columns_of(to_quantity(options.quantity)), identity);
}

}  // namespace

const std::vector<std::string>& patch_quantities() {
  static const std::vector<std::string> names = {"brdf", "energy", "sample"};
  return names;
}

namespace {

/// "0.3" as a number, "0.2,0.4" as two.
nlohmann::json as_number(const std::string& text) {
  nlohmann::json numbers = nlohmann::json::parse("[" + text + "]", nullptr, false);
  if (numbers.is_discarded()) return text;
  return numbers.size() == 1 ? numbers.front() : numbers;
}

}  // namespace

EvalSubject load_subject(const MapOptions& map, const MethodOptions& method, const MethodSettings& settings) {
  if (!method_of(method).traits().map) {
    nlohmann::json description;
    for (const SettingEntry& entry : list_settings(settings))
      description[entry.key] = entry.words.empty() ? as_number(entry.value) : nlohmann::json(entry.value);
    return {std::nullopt, description};
  }
  if (map.path.empty()) throw UsageError(fmt::format("--ndf {} needs a --map", method.name));
  SurfaceReport report;
  Surface surface = load_map(map, &report);
  const nlohmann::json description = {{"file", map.path},           {"width", surface.width()},
                                      {"height", surface.height()}, {"interpolation", map.interpolation},
                                      {"notes", report.notes},      {"warnings", report.warnings}};
  return {std::move(surface), description};
}

int evaluate_patches(const PatchEvaluation& options) {
  const Method& method = method_of(options.method);
  if (!method.traits().brdf)
    throw UsageError(fmt::format(
        "--quantity {}: {} has no BRDF of its own; available: {}", options.quantity, method.name(),
        fmt::join(options.method.methods->names([](const MethodTraits& traits) { return traits.brdf; }),
                  ", ")));
  if (method.traits().map && options.map.path.empty())
    throw UsageError(fmt::format("--ndf {} needs a --map", method.name()));
  const std::unique_ptr<MethodSettings> settings = settings_of(options.method);
  const Outputs outputs({options.output.file(), options.json}, {options.map.path, options.queries});

  const Stopwatch loading;
  std::optional<double> roughness = options.roughness;
  if (settings->own_roughness())
    roughness = options.method.given("microroughness") ? settings->own_roughness() : std::nullopt;
  const PatchTable table(options.queries, to_quantity(options.quantity), roughness);
  const EvalSubject subject = load_subject(options.map, options.method, *settings);
  const TableRange rows = options.output.rows(table.size());
  table.check(rows, [&](const ViewQuery& query) { return view_problem(method, query, subject.map()); });
  const double load_seconds = loading.seconds();
  const Stopwatch building;
  Device device(options.device.index());
  const std::unique_ptr<PatchBrdf> brdf = method.make_brdf(&device, subject.map(), *settings);
  const double build_seconds = building.seconds();
  const Stopwatch evaluating;
  ValueFile output = open_output(options, table);
  work_with_progress(rows.count(), [&](std::size_t first, std::size_t count) {
    output.append(answer(options, table, brdf.get(), rows.first + first, count));
  });
  output.finish();
  const double seconds = evaluating.seconds();

  if (const std::size_t replaced = brdf->replaced())
    spdlog::warn("{} answers were not finite: 0 is in their place", replaced);
  spdlog::info("{} rows of {} by {} on {} in {:.3g} s", rows.count(), options.quantity, brdf->name(),
               device.info().name, seconds);
  if (options.json.empty()) return 0;
  write_json(options.json,
             {{"command", "eval"},
              {"quantity", options.quantity},
              {"evaluator", brdf->name()},
              {"masking", options.method.text("masking", "exact")},
              {"compensation", options.method.text("compensation", "diffuse")},
              {"energy", options.method.text("energy", "exact")},
              {"part", options.part},
              {"seed", seed_of(options)},
              {subject.surface ? "map" : "glints", subject.description},
              {"device", describe_device(device.info())},
              {"device_bytes", brdf->device_bytes()},
              {"seconds",
               {{"load", load_seconds},
                {"build", build_seconds},
                {"evaluate", seconds},
                {"device", brdf->device_seconds()}}},
              {"queries", rows.count()},
              {"replaced_answers", brdf->replaced()},
              {"queries_per_second", seconds > 0 ? static_cast<double>(rows.count()) / seconds : 0.0},
              {"output", options.output.file()}});
  return 0;
}

}  // namespace mica::host::app
