#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "host/app/run_command.h"
#include "host/base/interrupt.h"

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("mica"));
  spdlog::set_pattern("%^%l%$: %v");
  mica::host::catch_interrupts();
  return mica::host::app::run_command(argc, argv, mica::host::MethodRegistry::builtin());
}
