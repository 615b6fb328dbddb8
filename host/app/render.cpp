#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>

#include "host/app/commands.h"
#include "host/app/interrupt.h"
#include "host/app/output.h"
#include "host/app/progress.h"
#include "host/base/error.h"
#include "host/engine/render.h"
#include "host/job/job.h"
#include "host/report/report.h"

namespace mica::app {
namespace {

struct Options {
  std::string job, output, json, frames;
  std::vector<std::string> overrides;
  int device = 0;
  bool quiet = false;
};

/// FILE.exr and its preview FILE.png; a name that ends in .png asks for the preview alone.
struct OutputNames {
  std::string exr, png;
};
OutputNames output_names(const Options& options) {
  namespace fs = std::filesystem;
  const fs::path wanted = options.output.empty()
                              ? fs::path("out") / fs::path(options.job).stem().concat(".exr")
                              : fs::path(options.output);
  if (wanted.extension() == ".png") return {"", wanted.string()};
  if (wanted.extension() == ".exr")
    return {wanted.string(), fs::path(wanted).replace_extension(".png").string()};
  throw UsageError(fmt::format("-o {}: expected a file name that ends in .exr or .png", wanted.string()));
}

int run(const Options& options) {
  if (!options.frames.empty() && options.frames != "0" && options.frames != "0-0")
    throw UsageError(fmt::format("--frames {}: the job has one frame, 0", options.frames));
  const OutputNames names = output_names(options);
  const Job job = load_job(options.job, options.overrides);
  const Plan plan = make_plan(job);
  Device device(options.device);
  for (const std::string& path : {names.exr, names.png, options.json})
    if (!path.empty()) prepare_output(path);

  Progress progress("rows", options.quiet);
  if (!options.quiet) fmt::print(stderr, "{}", describe(plan));
  const RenderResult result = render(job, plan, device, [&](int done, int rows) {
    check_interrupt();
    progress.update(done, rows);
  });
  for (const std::string& note : result.surface_notes) spdlog::info("{}", note);
  for (const std::string& warning : result.surface_warnings) spdlog::warn("{}", warning);

  if (!names.exr.empty()) write_exr(names.exr, result.image);
  write_png(names.png, result.image, job.image.exposure);
  if (!options.json.empty()) write_file_atomically(options.json, render_json(job, device.info(), result));
  if (!options.quiet) {
    fmt::print(stderr, "{}", render_summary(device.info(), result));
    fmt::print(stderr, "wrote     {}{}{}\n", names.exr, names.exr.empty() ? "" : " and ", names.png);
  }
  return 0;
}

}  // namespace

void add_render(CLI::App& app, Command* chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("render", "Render the image of a job file");
  command->add_option("job", options->job, "Job file, TOML")->required();
  command->add_option("-o,--output", options->output,
                      "FILE.exr (with FILE.png beside it) or FILE.png; default out/<name of the job>.exr");
  command->add_option("--set", options->overrides, "Override a setting: key.path=value, as often as needed");
  command->add_option("--frames", options->frames, "Frames A-B to render");
  command->add_option("--device", options->device, "Number of the OpenCL device, see `mica devices`");
  command->add_option("--json", options->json, "Write what was done: plan, bytes, seconds, queries/s, audit");
  command->add_flag("--quiet", options->quiet, "No progress and no summary");
  command->callback([=] { *chosen = [=] { return run(*options); }; });
}

}  // namespace mica::app
