#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <optional>
#include <set>

#include "host/app/commands.h"
#include "host/app/exit_code.h"
#include "host/app/frame_range.h"
#include "host/app/max_memory.h"
#include "host/app/output.h"
#include "host/app/progress.h"
#include "host/app/say.h"
#include "host/base/interrupt.h"
#include "host/job/input_files.h"
#include "host/job/job.h"
#include "host/render/render.h"
#include "host/report/report.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

struct RenderOptions {
  std::string job, output, json, frames;
  std::vector<std::string> overrides;
  int device = 0;
  MaxMemory max_memory;
  bool quiet = false;
};

/// FILE.exr and its preview FILE.png; a name that ends in .png asks for the preview alone.
struct OutputNames {
  std::string exr, png;
};
OutputNames output_names(const RenderOptions& options) {
  namespace fs = std::filesystem;
  const fs::path wanted = options.output.empty()
                              ? fs::path("out") / fs::path(options.job).stem().concat(".exr")
                              : fs::path(options.output);
  if (wanted.extension() == ".png") return {"", wanted.string()};
  if (wanted.extension() == ".exr")
    return {wanted.string(), fs::path(wanted).replace_extension(".png").string()};
  throw UsageError(fmt::format("-o {}: expected a file name that ends in .exr or .png", wanted.string()));
}

/// Names of one frame's files; numbered when the job has frames.
OutputNames names_of_frame(const OutputNames& names, const Job& job, int frame) {
  if (!job.frames.given) return names;
  return {numbered(names.exr, frame), numbered(names.png, frame)};
}

/// What the frames `first` to `last` write.
std::vector<std::string> outputs_of(const OutputNames& names, const Job& job, int first, int last) {
  std::vector<std::string> paths;
  for (int frame = first; frame <= last; ++frame) {
    const OutputNames of_frame = names_of_frame(names, job, frame);
    paths.insert(paths.end(), {of_frame.exr, of_frame.png});
  }
  return paths;
}

/// Renders the frames of a job one after the other, and keeps on when one fails.
class FrameLoop {
 public:
  FrameLoop(const RenderOptions& options, const Job& job, const OutputNames& names, const DeviceInfo& device)
      : options_(options), job_(job), names_(names), device_(device) {}

  /// What was found while surfaces and images were read, before a long rendering and not after it.
  void say_findings(const BuiltJob& built) { say_once(built.notes(), built.warnings()); }

  void render(BuiltJob& built, int frame) {
    try {
      render_and_write(built, frame);
      ++done_;
    } catch (const Error& error) {
      if (!job_.frames.given) throw;
      spdlog::error("frame {}: {}", frame, error.what());
      report([&] { return failure_json(frame, error.what()); });
      failed_ = exit_code_of(error.kind());
    }
  }

  /// The JSON of all frames, or of the only one.
  std::string json() const { return job_.frames.given ? frames_json(reports_) : reports_.front(); }

  ExitCode exit_code() const {
    if (!failed_) return ExitCode::done;
    return done_ > 0 ? ExitCode::some_images_failed : *failed_;
  }

 private:
  void render_and_write(BuiltJob& built, int frame) {
    const OutputNames names = names_of_frame(names_, job_, frame);
    Progress progress(job_.frames.given ? fmt::format("rows of frame {}", frame) : "rows", options_.quiet);
    const RenderResult result = render_frame(built, frame, device_, [&](int rows, int all) {
      check_interrupt();
      progress.update(rows, all);
    });
    say_once(result.surface_notes, result.surface_warnings);
    if (!names.exr.empty()) write_exr(names.exr, result.image);
    write_png(names.png, result.image, job_.image.exposure, job_.image.tone_map);
    report([&] { return render_json(job_, device_, result); });
    if (options_.quiet) return;
    say("{}", render_summary(device_, result));
    say("wrote     {}{}{}\n", names.exr, names.exr.empty() ? "" : " and ", names.png);
  }

  /// Reports are kept only for who wants them: a sequence may be long.
  template <typename Make>
  void report(const Make& make) {
    if (!options_.json.empty()) reports_.push_back(make());
  }

  /// What was not said of the frame before.
  void say_once(const std::vector<std::string>& notes, const std::vector<std::string>& warnings) {
    for (const std::string& note : notes)
      if (said_.count(note) == 0) spdlog::info("{}", note);
    for (const std::string& warning : warnings)
      if (said_.count(warning) == 0) spdlog::warn("{}", warning);
    said_ = {notes.begin(), notes.end()};
    said_.insert(warnings.begin(), warnings.end());
  }

  const RenderOptions& options_;
  const Job& job_;
  const OutputNames& names_;
  const DeviceInfo& device_;
  std::set<std::string> said_;
  std::vector<std::string> reports_;
  int done_ = 0;
  std::optional<ExitCode> failed_;
};

int run(const RenderOptions& options, const MethodRegistry& methods) {
  const OutputNames names = output_names(options);
  const Job job = load_job(options.job, options.overrides, methods, options.max_memory.bytes());
  const FrameRange frames = choose_frames(options.frames, job.frames);
  const Plan plan = make_plan(job);
  Device device(options.device);
  std::vector<std::string> at_once = outputs_of(names, job, frames.first, frames.first);
  at_once.push_back(options.json);
  const Outputs outputs(at_once, input_files(job), outputs_of(names, job, frames.first + 1, frames.last));

  if (!options.quiet) say("{}", describe(plan));
  BuiltJob built(job, plan, device, frames.first);
  FrameLoop loop(options, job, names, device.info());
  loop.say_findings(built);
  for (int frame = frames.first; frame <= frames.last; ++frame) loop.render(built, frame);
  if (!options.json.empty()) write_file_atomically(options.json, loop.json());
  return static_cast<int>(loop.exit_code());
}

}  // namespace

void add_render(CommandLine& app, Command* chosen, const MethodRegistry& methods) {
  auto options = std::make_shared<RenderOptions>();
  CommandLine* command = app.add_subcommand("render", "Render the image of a job file");
  command->add_option("job", options->job, "Job file, TOML").required();
  command->add_option("-o,--output", options->output,
                      "FILE.exr (with FILE.png beside it) or FILE.png; default out/<name of the job>.exr; "
                      "frames are numbered, FILE.0007.exr");
  command->add_option("--set", options->overrides, "Override a setting: key.path=value, as often as needed");
  command->add_option("--frames", options->frames,
                      "Frames A-B, or A, of those that the job has; default all");
  command->add_option("--device", options->device, "Number of the OpenCL device, see `mica devices`");
  command->add_option("--json", options->json, "Write what was done: plan, bytes, seconds, queries/s, audit");
  add_max_memory(command, &options->max_memory);
  command->add_flag("--quiet", options->quiet, "No progress and no summary");
  command->callback([=, &methods] { *chosen = [=, &methods] { return run(*options, methods); }; });
}

}  // namespace mica::host::app
