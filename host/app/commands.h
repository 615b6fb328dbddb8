#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>

#include "host/methods/registry.h"

namespace mica::host::app {

/// What a subcommand does once the command line is parsed; returns the exit code, throws mica::Error.
using Command = std::function<int()>;

/// Each adds its subcommand to `app`. When it is called, `*chosen` is set. The methods have to outlive the
/// command.
void add_render(CLI::App& app, Command* chosen, const MethodRegistry& methods);
void add_check(CLI::App& app, Command* chosen, const MethodRegistry& methods);
void add_ndf(CLI::App& app, Command* chosen, const MethodRegistry& methods);
void add_eval(CLI::App& app, Command* chosen, const MethodRegistry& methods);
void add_map(CLI::App& app, Command* chosen, const MethodRegistry& methods);
void add_devices(CLI::App& app, Command* chosen, const MethodRegistry& methods);
void add_selftest(CLI::App& app, Command* chosen, const MethodRegistry& methods);
void add_bench(CLI::App& app, Command* chosen, const MethodRegistry& methods);
void add_manual(CLI::App& app, Command* chosen, const MethodRegistry& methods);

}  // namespace mica::host::app
