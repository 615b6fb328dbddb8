#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <optional>

#include "host/app/commands.h"
#include "host/app/device_option.h"
#include "host/app/map_options.h"
#include "host/app/max_memory.h"
#include "host/app/output.h"
#include "host/image/image.h"
#include "host/job/input_files.h"
#include "host/job/job.h"
#include "host/render/estimate.h"
#include "host/render/plan.h"
#include "host/report/report.h"

namespace mica::host::app {
namespace {

struct CheckOptions {
  std::string job, json;
  std::vector<std::string> overrides;
  DeviceOption device;
  MaxMemory max_memory;
};

/// Nothing when there is no device to ask: the job can be checked all the same.
std::optional<Estimate> try_estimate(const Job& job, const Plan& plan, const DeviceOption& option) {
  if (list_devices().empty()) {
    spdlog::warn("no OpenCL device found: the time is not estimated");
    return std::nullopt;
  }
  Device device(option.index());
  return estimate(job, plan, device);
}

int run(const CheckOptions& options, const MethodRegistry& methods) {
  const Job job = load_job(options.job, options.overrides, methods, options.max_memory.bytes());
  const Plan plan = make_plan(job);
  const Outputs outputs({options.json}, input_files(job));
  const std::optional<Estimate> expected = try_estimate(job, plan, options.device);
  if (expected) log_report(expected->findings);
  if (!options.json.empty()) write_file_atomically(options.json, plan_json(job, plan, expected));
  fmt::print("{}", describe(plan));
  if (expected)
    fmt::print("estimate: {} queries, {:.1f} s, {:.1f} MiB on the device\n", expected->queries,
               expected->seconds, static_cast<double>(expected->device_bytes) / (1 << 20));
  return 0;
}

}  // namespace

void add_check(CommandLine& app, Command* chosen, const MethodRegistry& methods) {
  auto options = std::make_shared<CheckOptions>();
  CommandLine* command = app.add_subcommand("check", "Validate a job and print its plan; render nothing");
  command->add_option("job", options->job, "Job file, TOML").required();
  command->add_option("--set", options->overrides, "Override a setting: key.path=value, as often as needed");
  add_device_option(command, &options->device);
  add_max_memory(command, &options->max_memory);
  command->add_option("--json", options->json, "Write the plan and the estimate as JSON");
  command->callback([=, &methods] { *chosen = [=, &methods] { return run(*options, methods); }; });
}

}  // namespace mica::host::app
