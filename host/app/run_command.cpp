#include "host/app/run_command.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <system_error>

#include "host/app/about.h"
#include "host/app/commands.h"
#include "host/app/exit_code.h"
#include "host/app/say.h"
#include "host/app/thread_limit.h"
#include "host/base/interrupt.h"
#include "mica/error.h"
#include "mica/method.h"

namespace mica::host::app {
namespace {

int code(ExitCode exit_code) {
  return static_cast<int>(exit_code);
}

int parse_and_run(int argc, const char* const* argv, const MethodRegistry& methods) {
  const ThreadLimit threads;
  CommandLine app("Mica evaluates glint normal distribution functions on OpenCL and makes pictures of them.");
  app.version_flag("--version", about);
  app.require_subcommand();
  Command chosen;
  for (const auto add : {add_render, add_glints, add_join, add_warm, add_status, add_check, add_ndf, add_eval,
                         add_map, add_devices, add_selftest, add_bench, add_manual})
    add(app, &chosen, methods);
  if (const std::optional<int> code = app.parse(argc, argv)) return *code;
  const int done = chosen();
  check_interrupt();  // also when it came too late to stop anything
  return done;
}

/// What standard output did not take is lost, and must not look like success.
int with_results_out(int done) {
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && !std::ferror(stdout) && std::cout) return done;
  say("mica: standard output: cannot write: {}\n", std::strerror(errno ? errno : EIO));
  return code(ExitCode::file);
}

}  // namespace

int run_command(int argc, const char* const* argv, const MethodRegistry& methods) {
  try {
    return with_results_out(parse_and_run(argc, argv, methods));
  } catch (const Interrupted& interrupted) {
    say("mica: stopped by signal {}; nothing unfinished was written\n", interrupted.signal());
    return 128 + interrupted.signal();
  } catch (const Error& error) {
    say("mica: {}\n", presentable(error.what()));
    return code(exit_code_of(error.kind()));
  } catch (const std::bad_alloc&) {
    say("mica: the host's memory does not suffice\n");
    return code(ExitCode::device);
  } catch (const std::system_error& error) {  // of printing
    say("mica: {}\n", presentable(error.what()));
    return code(ExitCode::file);
  } catch (const std::exception& error) {
    say("mica: internal error: {}\n", presentable(error.what()));
    return code(ExitCode::device);
  }
}

}  // namespace mica::host::app

MICA_BEGIN_NAMESPACE

int run_command(int argc, const char* const* argv, const Methods& methods) {
  return host::app::run_command(argc, argv, *methods.implementation());
}

MICA_END_NAMESPACE
