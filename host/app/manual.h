#pragma once

#include <string>

#include "host/app/command_words.h"

/// Texts that are made of the command line's own options, so that they cannot say anything else than
/// `--help`.
namespace mica::host::app {

/// The page of `man mica`, in the macros of man(7).
std::string man_page(const CommandWords& program);

/// What completes the command line in each shell.
std::string bash_completion(const CommandWords& program);
std::string zsh_completion(const CommandWords& program);
std::string fish_completion(const CommandWords& program);

}  // namespace mica::host::app
