// mica bench: speed against error, side by side in one run.
#include <fmt/format.h>

#include "host/app/commands.h"
#include "host/app/device_option.h"
#include "host/app/output.h"
#include "host/app/say.h"
#include "host/base/interrupt.h"
#include "host/base/stopwatch.h"
#include "host/image/image.h"
#include "host/measure/suite.h"
#include "host/report/bench_report.h"

namespace mica::host::app {
namespace {

struct BenchOptions {
  std::string suite = "quick", json, html;
  DeviceOption device;
  bool quiet = false;
};

int run(const BenchOptions& options, const MethodRegistry& methods) {
  const Outputs outputs({options.json, options.html});
  Device device(options.device.index());
  const Stopwatch watch;
  const auto progress = [&](const std::string& what) {
    check_interrupt();
    if (!options.quiet) say("{:6.1f} s  {}\n", watch.seconds(), what);
  };
  const bench::Results results = bench::run_suite(options.suite, device, progress, methods);
  fmt::print("{}", bench_summary(results));
  if (!options.json.empty()) write_file_atomically(options.json, bench_json(results));
  if (!options.html.empty()) write_file_atomically(options.html, bench_page(results));
  if (!options.quiet) say("took {:.0f} s\n", results.seconds);
  return 0;
}

}  // namespace

void add_bench(CommandLine& app, Command* chosen, const MethodRegistry& methods) {
  auto options = std::make_shared<BenchOptions>();
  CommandLine* command =
      app.add_subcommand("bench", "Measures every evaluator's speed and error, side by side in one run");
  command->footer(
      "quick takes less than a minute, standard less than ten, on two idle cores. Compare ratios within a "
      "run,\n"
      "not speeds of two runs. docs/benchmark.md says what is measured and how.");
  command->add_option("suite", options->suite, "tiny, quick or standard")
      .check(one_of(bench::suite_names()))
      .show_default();
  command->add_option("--json", options->json, "Writes every number as JSON").type_name("FILE");
  command->add_option("--html", options->html, "Writes a page with plots and pictures; it needs no network")
      .type_name("FILE");
  add_device_option(command, &options->device);
  command->add_flag("--quiet", options->quiet, "No progress");
  command->callback([=, &methods] { *chosen = [=, &methods] { return run(*options, methods); }; });
}

}  // namespace mica::host::app
