#include "host/app/run_program.h"

#include <fcntl.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>

#include "host/app/run_command.h"
#include "host/base/interrupt.h"
#include "mica/method.h"

namespace mica::host::app {
namespace {

/// A file that is opened later would get the number of a closed stream, and what is written to that.
void occupy_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      open("/dev/null", O_RDONLY);  // so that writing fails, too
}

}  // namespace

int run_program(int argc, const char* const* argv, const MethodRegistry& methods) {
  occupy_closed_streams();
  spdlog::set_default_logger(spdlog::stderr_color_mt("mica"));
  spdlog::set_error_handler([](const std::string&) {});  // a full log does not end the work
  spdlog::set_pattern("%^%l%$: %v");
  catch_interrupts();
  return run_command(argc, argv, methods);
}

}  // namespace mica::host::app

MICA_BEGIN_NAMESPACE

int run_program(int argc, const char* const* argv, const Methods& methods) {
  return host::app::run_program(argc, argv, *methods.implementation());
}

MICA_END_NAMESPACE
