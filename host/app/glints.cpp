// mica glints: a layer of glints over the picture of another renderer.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "host/app/commands.h"
#include "host/app/device_option.h"
#include "host/app/max_memory.h"
#include "host/app/output.h"
#include "host/app/progress.h"
#include "host/app/say.h"
#include "host/base/interrupt.h"
#include "host/base/printable.h"
#include "host/gbuffer/glint_layer.h"
#include "host/job/input_files.h"
#include "host/report/report.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

struct GlintsOptions {
  std::string buffer, scene, output, camera, json, aovs, preset;
  std::string filter{word_of(FilterKind::gaussian)}, other_ids = "refuse";
  std::vector<std::string> channels, overrides;
  std::optional<double> filter_width;
  int scale = 1;
  DeviceOption device;
  MaxMemory max_memory;
  bool per_lamp = false, quiet = false;
};

/// "D,error"
std::vector<LayerAov> parse_aovs(const std::string& text) {
  std::vector<LayerAov> aovs;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const std::optional<LayerAov> aov = parse_word<LayerAov>(word);
    if (!aov)
      throw UsageError(fmt::format("--aovs {}: found \"{}\"; expected any of: {}", printable(text),
                                   printable(word), fmt::join(list_words<LayerAov>(), ", ")));
    aovs.push_back(*aov);
    begin = end + 1;
  }
  return aovs;
}

LayerSettings layer_settings(const GlintsOptions& options) {
  LayerSettings settings;
  settings.filter = {parse_word<FilterKind>(options.filter).value(), options.filter_width.value_or(0)};
  settings.scale = options.scale;
  settings.aovs = parse_aovs(options.aovs);
  settings.per_lamp = options.per_lamp;
  return settings;
}

std::string layer_json(const Job& job, const DeviceInfo& device, const LayerResult& layer) {
  auto json = nlohmann::ordered_json::parse(render_json(job, device, layer.result));
  const BufferCounts& counts = layer.counts;
  json["pixels"] = {{"covered", counts.covered},
                    {"one_sided", counts.one_sided},
                    {"without_neighbours", counts.alone},
                    {"broken", counts.broken}};
  json["channels"] = layer.channels;
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void tell(const std::vector<std::string>& notes, const std::vector<std::string>& warnings) {
  for (const std::string& note : notes) spdlog::info("{}", note);
  for (const std::string& warning : warnings) spdlog::warn("{}", warning);
}

int run(const GlintsOptions& options, const MethodRegistry& methods) {
  const LayerSettings settings = layer_settings(options);
  check(settings);
  const std::string camera = options.camera.empty()
                                 ? std::filesystem::path(options.buffer).replace_extension(".json").string()
                                 : options.camera;
  Job job = load_job(options.scene, options.overrides, methods, options.max_memory.bytes(), JobUse::layer);
  std::vector<std::string> inputs = input_files(job);
  inputs.insert(inputs.end(), {options.buffer, camera});
  const Outputs outputs({options.output, options.json}, inputs);
  const BufferView view = read_view(camera);
  BufferOptions choice{{}, options.channels, options.other_ids == "skip"};
  if (!options.preset.empty()) choice.presets = {parse_word<BufferPreset>(options.preset).value()};
  GBuffer buffer(options.buffer, view, job.scene.materials, settings.scale, choice);
  job = layer_job(std::move(job), view, buffer.window(), settings);
  const Plan plan = make_plan(job);
  Device device(options.device.index());
  if (!options.quiet) say("{}", describe(plan));
  tell(view.notes, {});
  tell(buffer.notes(), {});
  Progress progress("rows", options.quiet);
  const LayerResult layer =
      write_glint_layer(options.output, job, plan, &buffer, view, settings, device, [&](int rows, int all) {
        check_interrupt();
        progress.update(rows, all);
      });
  tell(layer.result.surface_notes, layer.result.surface_warnings);
  if (!options.json.empty()) write_file_atomically(options.json, layer_json(job, device.info(), layer));
  if (options.quiet) return 0;
  say("{}", render_summary(device.info(), layer.result));
  say("wrote     {}\n", options.output);
  return 0;
}

void add_options(CommandLine* command, GlintsOptions* options) {
  command->add_option("gbuffer", options->buffer, "G-buffer, OpenEXR of 32-bit floats, one sample a pixel")
      .required()
      .type_name("GBUFFER");
  command
      ->add_option("--scene", options->scene,
                   "Job file with surfaces and materials, each with its `id`, TOML")
      .required()
      .type_name("FILE");
  command->add_option("-o,--output", options->output, "Layer to be added to the picture, FILE.exr")
      .required()
      .type_name("FILE");
  command->add_option("--camera", options->camera, "Camera and lamps; default GBUFFER's name with .json")
      .type_name("FILE");
  command->add_option("--preset", options->preset, "Whose names of channels are looked for; default any")
      .check(one_of(list_words<BufferPreset>()));
  command
      ->add_option("--channel", options->channels,
                   "ROLE=NAME: a layer (ViewLayer.Position) or channels (P.x,P.y,P.z) for position, normal, "
                   "true_normal, tangent, uv, uv_dx, uv_dy, dp_du, dp_dv or id")
      .repeated();
  command->add_option("--other-ids", options->other_ids, "What to do with ids that no material has")
      .check(one_of({"refuse", "skip"}))
      .show_default();
  command->add_option("--filter", options->filter, "Pixel filter of the picture below")
      .check(one_of({"gaussian", "blackman-harris", "box"}))
      .show_default();
  command
      ->add_option("--filter-width", options->filter_width,
                   "Pixels: standard deviation of gaussian (0.5), whole width of the others (1.5 and 1)")
      .check(between(0.1, 8.0));
  command->add_option("--scale", options->scale, "The G-buffer has N times the layer's width and height")
      .check(between(1, 16))
      .type_name("N");
  command->add_flag("--per-lamp", options->per_lamp, "Besides their sum a layer LAMP.R, G, B for each lamp");
  command->add_option("--aovs", options->aovs, "Besides, with commas: D, footprint, error, coverage")
      .type_name("NAMES");
  command->add_option("--set", options->overrides, "Override a setting: key.path=value, as often as needed");
  add_device_option(command, &options->device);
  command->add_option("--json", options->json,
                      "Write what was done: plan, bytes, seconds, queries/s, audit, pixels");
  add_max_memory(command, &options->max_memory);
  command->add_flag("--quiet", options->quiet, "No progress and no summary");
}

}  // namespace

void add_glints(CommandLine& app, Command* chosen, const MethodRegistry& methods) {
  auto options = std::make_shared<GlintsOptions>();
  CommandLine* command = app.add_subcommand(
      "glints", "Make a layer of glints over another renderer's picture, from its G-buffer");
  add_options(command, options.get());
  command->callback([=, &methods] { *chosen = [=, &methods] { return run(*options, methods); }; });
}

}  // namespace mica::host::app
