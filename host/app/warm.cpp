// mica warm: compiles what a job needs before many processes need it at once.
#include <fmt/format.h>

#include "host/app/commands.h"
#include "host/app/device_option.h"
#include "host/app/max_memory.h"
#include "host/job/job.h"
#include "host/render/estimate.h"
#include "host/render/plan.h"

namespace mica::host::app {
namespace {

struct WarmOptions {
  std::string job;
  std::vector<std::string> overrides;
  DeviceOption device;
  MaxMemory max_memory;
};

int run(const WarmOptions& options, const MethodRegistry& methods) {
  const Job job = load_job(options.job, options.overrides, methods, options.max_memory.bytes());
  const Plan plan = make_plan(job);
  Device device(options.device.index());
  estimate(job, plan, device);  // a few queries: drivers compile a kernel to its end when it first runs
  fmt::print("{}: {} of {} programs compiled, the others were there\n", device.info().name, device.compiled(),
             device.programs().size());
  return 0;
}

}  // namespace

void add_warm(CommandLine& app, Command* chosen, const MethodRegistry& methods) {
  auto options = std::make_shared<WarmOptions>();
  CommandLine* command =
      app.add_subcommand("warm", "Compile the kernels that a job needs into the cache; render nothing");
  command->add_option("job", options->job, "Job file, TOML").required();
  command->add_option("--set", options->overrides, "Override a setting: key.path=value, as often as needed");
  add_device_option(command, &options->device);
  add_max_memory(command, &options->max_memory);
  command->callback([=, &methods] { *chosen = [=, &methods] { return run(*options, methods); }; });
}

}  // namespace mica::host::app
