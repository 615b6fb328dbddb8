#pragma once

#include <functional>
#include <memory>

#include "host/app/command_line.h"
#include "host/methods/registry.h"

namespace mica::host::app {

/// What a subcommand does once the command line is parsed; returns the exit code, throws mica::Error.
using Command = std::function<int()>;

/// Each adds its subcommand to `app`. When it is called, `*chosen` is set. The methods have to outlive the
/// command.
void add_render(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_join(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_glints(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_warm(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_status(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_check(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_ndf(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_eval(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_map(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_devices(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_selftest(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_bench(CommandLine& app, Command* chosen, const MethodRegistry& methods);
void add_manual(CommandLine& app, Command* chosen, const MethodRegistry& methods);

}  // namespace mica::host::app
