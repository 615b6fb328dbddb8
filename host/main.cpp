#include <fcntl.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>

#include "host/app/run_command.h"
#include "host/base/interrupt.h"

namespace {

/// A file that is opened later would get the number of a closed stream, and what is written to that.
void occupy_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      open("/dev/null", O_RDONLY);  // so that writing fails, too
}

}  // namespace

int main(int argc, char** argv) {
  occupy_closed_streams();
  spdlog::set_default_logger(spdlog::stderr_color_mt("mica"));
  spdlog::set_error_handler([](const std::string&) {});  // a full log does not end the work
  spdlog::set_pattern("%^%l%$: %v");
  mica::host::catch_interrupts();
  return mica::host::app::run_command(argc, argv, mica::host::MethodRegistry::builtin());
}
