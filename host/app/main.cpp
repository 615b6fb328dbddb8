#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <exception>

#include "host/app/commands.h"
#include "host/app/exit_code.h"
#include "host/app/interrupt.h"
#include "mica/error.h"
#include "mica/version.h"

namespace {

int code(mica::host::app::ExitCode exit_code) {
  return static_cast<int>(exit_code);
}

int run(int argc, char** argv) {
  CLI::App app("Mica evaluates glint normal distribution functions on OpenCL and makes pictures of them.");
  app.set_version_flag("--version", mica::version());
  app.require_subcommand(1);
  mica::host::app::Command chosen;
  mica::host::app::add_render(app, &chosen);
  mica::host::app::add_check(app, &chosen);
  mica::host::app::add_ndf(app, &chosen);
  mica::host::app::add_eval(app, &chosen);
  mica::host::app::add_map(app, &chosen);
  mica::host::app::add_devices(app, &chosen);
  mica::host::app::add_selftest(app, &chosen);
  mica::host::app::add_bench(app, &chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : code(mica::host::app::ExitCode::usage);
  }
  return chosen();
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("mica"));
  spdlog::set_pattern("%^%l%$: %v");
  mica::host::app::catch_interrupts();
  try {
    return run(argc, argv);
  } catch (const mica::host::app::Interrupted& interrupted) {
    fmt::print(stderr, "mica: stopped by signal {}; nothing unfinished was written\n", interrupted.signal());
    return 128 + interrupted.signal();
  } catch (const mica::Error& error) {
    fmt::print(stderr, "mica: {}\n", error.what());
    return code(mica::host::app::exit_code_of(error.kind()));
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "mica: the host's memory does not suffice\n");
    return code(mica::host::app::ExitCode::device);
  } catch (const std::exception& error) {
    fmt::print(stderr, "mica: internal error: {}\n", error.what());
    return code(mica::host::app::ExitCode::device);
  }
}
