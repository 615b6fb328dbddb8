#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "host/app/command_line.h"

namespace mica::host::app {

/// An option or a positional argument, as a manual or a shell needs to know it.
struct OptionWords {
  std::vector<std::string> names;    ///< "-o", "--output"; or the one name of a positional argument
  std::string description;           ///< one or more sentences, without line breaks
  std::string value;                 ///< "FILE", "TEXELS"; empty for a flag
  std::string range;                 ///< "in [1 - 4]", or empty
  std::vector<std::string> choices;  ///< the words that it takes, when it does not take all
  std::string usual;                 ///< what it is without being given; empty when there is nothing to say
  bool positional, required, repeats;

  bool takes_file() const { return choices.empty() && (value == "FILE" || value == "TEXT"); }
};

/// A command with the words that lead to it: {"map", "spectrum"}; the program itself is {}.
struct CommandWords {
  std::vector<std::string> path;
  std::string description, footer;
  std::vector<OptionWords> options;
  std::vector<CommandWords> commands;  ///< those below it

  std::string name() const { return path.empty() ? "" : path.back(); }
  /// The words of `path` with `separator` between them.
  std::string joined(const std::string& separator) const {
    return fmt::format("{}", fmt::join(path, separator));
  }
};

/// What `app` takes, down to its last subcommand; without what is hidden from its help.
CommandWords describe_command_line(const CommandLine& app);

}  // namespace mica::host::app
