#include "host/app/run_program.h"

#include <fcntl.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <new>

#include "host/app/exit_code.h"
#include "host/app/run_command.h"
#include "host/base/interrupt.h"
#include "host/base/leftovers.h"
#include "mica/method.h"

namespace mica::host::app {
namespace {

/// A file that is opened later would get the number of a closed stream, and what is written to that.
void occupy_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      open("/dev/null", O_RDONLY);  // so that writing fails, too
}

/// Libraries take memory in destructors, which cannot pass on that there is none.
[[noreturn]] void end_without_unwinding() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    remove_leftovers();
    std::fputs("mica: the host's memory does not suffice\n", stderr);
    _exit(static_cast<int>(ExitCode::device));
  } catch (...) {
  }
  std::abort();
}

int run_guarded(const std::function<int()>& run) {
  occupy_closed_streams();
  std::set_terminate(end_without_unwinding);
  try {
    spdlog::set_default_logger(spdlog::stderr_color_mt("mica"));
    spdlog::set_error_handler([](const std::string&) {});  // a full log does not end the work
    spdlog::set_pattern("%^%l%$: %v");
    catch_interrupts();
    return run();
  } catch (const std::exception& error) {  // no memory, not even to say so as others are said
    std::fputs("mica: ", stderr);
    std::fputs(error.what(), stderr);
    std::fputs("\n", stderr);
    return static_cast<int>(ExitCode::device);
  }
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  return run_guarded([&] { return run_command(argc, argv, MethodRegistry::builtin()); });
}

int run_program(int argc, const char* const* argv, const MethodRegistry& methods) {
  return run_guarded([&] { return run_command(argc, argv, methods); });
}

}  // namespace mica::host::app

MICA_BEGIN_NAMESPACE

int run_program(int argc, const char* const* argv, const Methods& methods) {
  return host::app::run_program(argc, argv, *methods.implementation());
}

MICA_END_NAMESPACE
