#include "host/app/run_command.h"

#include <fmt/format.h>
#include <cstdio>
#include <exception>

#include "host/app/about.h"
#include "host/app/commands.h"
#include "host/app/exit_code.h"
#include "host/base/interrupt.h"
#include "mica/error.h"
#include "mica/method.h"

namespace mica::host::app {
namespace {

int code(ExitCode exit_code) {
  return static_cast<int>(exit_code);
}

int parse_and_run(int argc, const char* const* argv, const MethodRegistry& methods) {
  CommandLine app("Mica evaluates glint normal distribution functions on OpenCL and makes pictures of them.");
  app.version_flag("--version", about);
  app.require_subcommand();
  Command chosen;
  for (const auto add :
       {add_render, add_check, add_ndf, add_eval, add_map, add_devices, add_selftest, add_bench, add_manual})
    add(app, &chosen, methods);
  if (const std::optional<int> code = app.parse(argc, argv)) return *code;
  return chosen();
}

}  // namespace

int run_command(int argc, const char* const* argv, const MethodRegistry& methods) {
  try {
    return parse_and_run(argc, argv, methods);
  } catch (const Interrupted& interrupted) {
    fmt::print(stderr, "mica: stopped by signal {}; nothing unfinished was written\n", interrupted.signal());
    return 128 + interrupted.signal();
  } catch (const Error& error) {
    fmt::print(stderr, "mica: {}\n", error.what());
    return code(exit_code_of(error.kind()));
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "mica: the host's memory does not suffice\n");
    return code(ExitCode::device);
  } catch (const std::exception& error) {
    fmt::print(stderr, "mica: internal error: {}\n", error.what());
    return code(ExitCode::device);
  }
}

}  // namespace mica::host::app

MICA_BEGIN_NAMESPACE

int run_command(int argc, const char* const* argv, const Methods& methods) {
  return host::app::run_command(argc, argv, *methods.implementation());
}

MICA_END_NAMESPACE
