#include "mica/glints.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "host/base/printable.h"
#include "host/gbuffer/glint_layer.h"
#include "host/job/input_files.h"
#include "host/library/subject.h"
#include "host/library/work.h"
#include "mica/error.h"

MICA_BEGIN_NAMESPACE

namespace {

template <typename Enum>
Enum word(const char* setting, const std::string& text) {
  if (const std::optional<Enum> found = host::parse_word<Enum>(text)) return *found;
  throw UsageError(fmt::format("{}: found \"{}\"; expected {}", setting, host::printable(text),
                               fmt::join(host::list_words<Enum>(), ", ")));
}

host::LayerSettings layer_settings(const GlintSettings& settings) {
  host::LayerSettings layer;
  layer.filter = {word<host::FilterKind>("filter", settings.filter), settings.filter_width};
  layer.scale = settings.scale;
  layer.per_lamp = settings.per_lamp;
  for (const std::string& aov : settings.aovs) layer.aovs.push_back(word<host::LayerAov>("aovs", aov));
  return layer;
}

host::BufferOptions buffer_options(const GlintSettings& settings) {
  host::BufferOptions options{{}, settings.channels, settings.skips_other_ids};
  if (!settings.preset.empty()) options.presets = {word<host::BufferPreset>("preset", settings.preset)};
  return options;
}

void refuse_to_overwrite(const std::vector<std::string>& inputs, const std::string& path) {
  for (const std::string& input : inputs) {
    std::error_code none;
    if (std::filesystem::equivalent(input, path, none))
      throw UsageError(fmt::format("{}: is to be written and is read; expected another name", path));
  }
}

}  // namespace

GlintLayer write_glints(const Device& device, const std::string& buffer, const std::string& scene,
                        const std::string& path, const GlintSettings& settings, const RunControl& control,
                        const Methods& methods) {
  const host::LayerSettings layer = layer_settings(settings);
  host::check(layer);
  const std::string camera = settings.camera.empty()
                                 ? std::filesystem::path(buffer).replace_extension(".json").string()
                                 : settings.camera;
  host::report(control, 0, 0);
  host::Job job =
      host::load_job(scene, settings.overrides, *methods.implementation(), 0, host::JobUse::layer);
  std::vector<std::string> inputs = host::input_files(job);
  inputs.insert(inputs.end(), {buffer, camera});
  refuse_to_overwrite(inputs, path);
  const host::BufferView view = host::read_view(camera);
  host::GBuffer opened(buffer, view, job.scene.materials, layer.scale, buffer_options(settings));
  job = host::layer_job(std::move(job), view, opened.window(), layer);
  const host::LayerResult made = host::write_glint_layer(
      path, job, host::make_plan(job), &opened, view, layer, *device.implementation(),
      [&](int rows, int all) {
        host::report(control, static_cast<std::size_t>(rows), static_cast<std::size_t>(all));
      });
  GlintLayer written{made.channels,     made.counts.covered, made.counts.one_sided,
                     made.counts.alone, made.counts.broken,  made.result.queries,
                     view.notes};
  for (const auto* notes : {&opened.notes(), &made.result.surface_notes, &made.result.surface_warnings})
    written.notes.insert(written.notes.end(), notes->begin(), notes->end());
  return written;
}

MICA_END_NAMESPACE
