#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <memory>
#include <set>
#include <vector>

#include "host/app/commands.h"
#include "host/app/device_option.h"
#include "host/app/frame_choice.h"
#include "host/app/frame_loop.h"
#include "host/app/json_log.h"
#include "host/app/max_memory.h"
#include "host/app/output.h"
#include "host/app/picture_names.h"
#include "host/app/say.h"
#include "host/base/interrupt.h"
#include "host/job/frame_list.h"
#include "host/job/input_files.h"
#include "host/job/job.h"
#include "host/report/report.h"
#include "mica/error.h"
#include "mica/version.h"

namespace mica::host::app {
namespace {

struct RenderOptions {
  std::string job, output, json, log, frames, shard, rows;
  std::vector<std::string> overrides;
  DeviceOption device;
  MaxMemory max_memory;
  bool quiet = false, skip_finished = false;
};

/// What is written of frames, and where the log is.
struct Targets {
  const PictureNames names;
  const PictureShare share;

  std::vector<std::string> of_frames(const Job& job, const std::vector<int>& frames) const {
    std::vector<std::string> paths;
    for (const int frame : frames) {
      const PictureNames of_frame = names_of_frame(names, job, frame, share);
      paths.insert(paths.end(), {of_frame.exr, of_frame.png});
    }
    return paths;
  }
};

/// Devices that share a job.
class Devices {
 public:
  Devices(const std::vector<int>& indices, const Plan& plan) {
    check_sharing(plan, indices.size());
    for (const int index : indices) devices_.push_back(std::make_unique<Device>(index));
    std::set<std::string> names;
    for (const auto& device : devices_) names.insert(device->info().name);
    info_ = devices_.front()->info();
    info_.name = fmt::format("{}", fmt::join(names, "; "));
  }
  std::vector<Device*> all() const {
    std::vector<Device*> all;
    for (const auto& device : devices_) all.push_back(device.get());
    return all;
  }
  /// Of the first, with the names of all.
  const DeviceInfo& info() const { return info_; }

 private:
  std::vector<std::unique_ptr<Device>> devices_;
  DeviceInfo info_;
};

/// One call of `mica render`.
class RenderRun {
 public:
  RenderRun(const RenderOptions& options, const MethodRegistry& methods)
      : options_(options), methods_(methods), log_(options.log) {}

  /// Does all of it; what goes wrong is in the log, too.
  int run() {
    try {
      const ExitCode code = render();
      log_.write("ended", {{"code", static_cast<int>(code)}});
      return static_cast<int>(code);
    } catch (const Interrupted& interrupted) {
      log_.write("stopped", {{"signal", interrupted.signal()}});
      throw;
    } catch (const Error& error) {
      tell_failure(word_of_kind(error.kind()), error.what());
      throw;
    } catch (const std::exception& error) {
      tell_failure("device", error.what());
      throw;
    }
  }

 private:
  ExitCode render() {
    const PictureNames names = picture_names(options_.job, options_.output);
    const Job job = load_job(options_.job, options_.overrides, methods_, options_.max_memory.bytes());
    frames_ = chosen_frames(options_.frames, job.frames);
    const Targets targets{names, picture_share(options_.shard, options_.rows, job.image.height)};
    if (!targets.share.is_all() && names.exr.empty())
      throw UsageError(fmt::format("-o {}: expected a name that ends in .exr for a part", names.png));
    const Plan plan = make_plan(job);
    tell_start(job, targets);
    std::vector<std::string> at_once = targets.of_frames(job, {frames_.front()});
    at_once.push_back(options_.json);
    if (std::filesystem::is_regular_file(options_.log)) at_once.push_back(options_.log);
    const Outputs outputs(at_once, input_files(job),
                          targets.of_frames(job, {frames_.begin() + 1, frames_.end()}));

    FrameLoop loop({job, targets.names, targets.share, log_, options_.quiet, !options_.json.empty()});
    const std::vector<int> wanted = skip_finished(job, targets, &loop);
    if (!wanted.empty()) render_frames(job, plan, wanted, &loop);
    if (!options_.json.empty()) write_file_atomically(options_.json, loop.json());
    return loop.exit_code();
  }

  /// @return the frames that are not finished.
  std::vector<int> skip_finished(const Job& job, const Targets& targets, FrameLoop* loop) {
    if (!options_.skip_finished) return frames_;
    const std::string inputs = hash_of_inputs(job);
    std::vector<int> rest;
    for (const int frame : frames_) {
      if (is_finished({job, targets.names, targets.share, log_}, frame, inputs))
        loop->skip(frame);
      else
        rest.push_back(frame);
    }
    return rest;
  }

  void render_frames(const Job& job, const Plan& plan, const std::vector<int>& frames, FrameLoop* loop) {
    frames_ = frames;
    const Devices devices(options_.device.indices(), plan);
    if (!options_.quiet) say("{}", describe(plan));
    log_.write("phase", {{"phase", "build"}, {"device", devices.info().name}});
    BuiltJob built(job, plan, devices.all(), frames.front());
    loop->say_findings(built);
    for (const int frame : frames) {
      loop->render(built, frame, devices.info());
      frames_.erase(frames_.begin());
    }
    int compiled = 0;
    std::size_t programs = 0;
    for (const Device* device : devices.all())
      compiled += device->compiled(), programs += device->programs().size();
    log_.write("kernels", {{"compiled", compiled}, {"of", programs}});
  }

  void tell_start(const Job& job, const Targets& targets) {
    nlohmann::json details = {{"mica", version()},
                              {"job", options_.job},
                              {"hash", fmt::format("{:016x}", job.hash)},
                              {"frames", frame_list(frames_)},
                              {"output", targets.names.exr.empty() ? targets.names.png : targets.names.exr}};
    if (job.frames.given) details["range"] = {job.frames.first, job.frames.last};
    if (targets.share.rows)
      details["rows"] = {targets.share.rows->first,
                         targets.share.rows->first + targets.share.rows->count - 1};
    log_.write("started", details);
  }

  /// Of what concerns no frame alone.
  void tell_failure(const std::string& kind, const std::string& message) {
    log_.write("failed", {{"kind", kind}, {"message", message}, {"frames", frame_list(frames_)}});
  }

  const RenderOptions& options_;
  const MethodRegistry& methods_;
  JsonLog log_;
  std::vector<int> frames_;  // that are still to come
};

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
                      "Frames A-B, A-BxN (each N-th), A, or several with commas; default MICA_FRAMES, or all "
                      "of the job");
  command
      ->add_option("--shard", options->shard,
                   "Render part K of N of the picture, into FILE.part-K-of-N.exr; see `mica join`")
      .type_name("K/N");
  command->add_option("--rows", options->rows, "Render these rows alone, from 0 at the top").type_name("A-B");
  command->add_flag("--skip-finished", options->skip_finished,
                    "Leave out what is there, whole, and by its header what the job would make");
  add_devices_option(command, &options->device, "lamps' densities");
  command->add_option("--json", options->json, "Write what was done: plan, bytes, seconds, queries/s, audit");
  command->add_option("--json-log", options->log, "Write what happens, one JSON object a line, at FILE's end")
      .type_name("FILE");
  add_max_memory(command, &options->max_memory);
  command->add_flag("--quiet", options->quiet, "No progress and no summary");
  command->callback(
      [=, &methods] { *chosen = [=, &methods] { return RenderRun(*options, methods).run(); }; });
}

}  // namespace mica::host::app
