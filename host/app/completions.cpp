// What completes the command line in bash, zsh and fish.
#include <fmt/format.h>

#include "host/app/manual.h"

namespace mica::host::app {
namespace {

using Words = std::vector<std::string>;

std::string spaced(const Words& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

/// In single quotes, for any of the three shells: each reads `'\''` as a quote.
std::string quoted(const std::string& text) {
  return "'" + replaced(text, "'", "'\\''") + "'";
}

Words option_names(const CommandWords& command) {
  Words names;
  for (const OptionWords& option : command.options)
    if (!option.positional) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

Words names_below(const CommandWords& command) {
  Words names;
  for (const CommandWords& below : command.commands) names.push_back(below.name());
  return names;
}

/// What may stand where no option does: names of commands, or an argument's choices.
Words argument_words(const CommandWords& command) {
  Words words = names_below(command);
  for (const OptionWords& option : command.options)
    if (option.positional) words.insert(words.end(), option.choices.begin(), option.choices.end());
  return words;
}

/// `command` and all below it, in the order of the help.
std::vector<const CommandWords*> all_commands(const CommandWords& command) {
  std::vector<const CommandWords*> all = {&command};
  for (const CommandWords& below : command.commands)
    for (const CommandWords* each : all_commands(below)) all.push_back(each);
  return all;
}

/// `'eval --ndf') words=...` for an option with choices, and nothing to offer but files for another value.
std::string bash_values(const CommandWords& command) {
  std::string text;
  for (const OptionWords& option : command.options) {
    if (option.positional || option.value.empty()) continue;
    std::string pattern;
    for (const std::string& name : option.names)
      pattern += (pattern.empty() ? "" : " | ") + quoted(command.joined(" ") + " " + name);
    text += fmt::format("    {}) words={} ;;\n", pattern, quoted(spaced(option.choices)));
  }
  return text;
}

/// A description inside a zsh specification, where brackets and colons have a meaning.
std::string zsh_text(std::string text) {
  for (const char* const special : {"\\", "[", "]", ":"})
    text = replaced(text, special, std::string("\\") + special);
  return text;
}

std::string zsh_action(const OptionWords& option) {
  if (!option.choices.empty()) return "(" + spaced(option.choices) + ")";
  return option.takes_file() ? "_files" : "";
}

std::string zsh_argument(const OptionWords& option, int position) {
  if (option.positional)
    return quoted(fmt::format("{}:{}:{}", position, zsh_text(option.names[0]), zsh_action(option)));
  const std::string value =
      option.value.empty() ? "" : fmt::format(":{}:{}", zsh_text(option.value), zsh_action(option));
  const std::string excludes = option.repeats ? "*" : fmt::format("({})", spaced(option.names));
  std::string text;
  for (const std::string& name : option.names)
    text += (text.empty() ? "" : " ") +
            quoted(fmt::format("{}{}[{}]{}", excludes, name, zsh_text(option.description), value));
  return text;
}

std::string zsh_function(const CommandWords& command) {
  return command.path.empty() ? "_mica" : "_mica_" + command.joined("_");
}

/// The part of a function that goes on to the commands below.
std::string zsh_commands(const CommandWords& command) {
  std::string list, cases;
  for (const CommandWords& below : command.commands) {
    list += " " + quoted(below.name() + ":" + zsh_text(below.description));
    cases += fmt::format("        {}) {} ;;\n", below.name(), zsh_function(below));
  }
  return fmt::format(
      "  case $state in\n    command)\n      local -a commands=({} )\n"
      "      _describe command commands\n      ;;\n"
      "    rest)\n      case $line[1] in\n{}      esac\n      ;;\n  esac\n",
      list, cases);
}

std::string zsh_body(const CommandWords& command) {
  std::string arguments;
  int position = 0;
  for (const OptionWords& option : command.options)
    arguments += " \\\n    " + zsh_argument(option, option.positional ? ++position : 0);
  if (command.commands.empty()) return fmt::format("  _arguments{}\n", arguments);
  return fmt::format(
      "  local curcontext=$curcontext state line\n"
      "  _arguments -C{} \\\n    '1:command:->command' '*::argument:->rest'\n{}",
      arguments, zsh_commands(command));
}

/// The condition under which fish is about to complete `command`'s own words.
std::string fish_condition(const CommandWords& command) {
  if (command.path.empty()) return "__fish_use_subcommand";
  std::string condition;
  for (const std::string& word : command.path)
    condition += (condition.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word);
  if (!command.commands.empty())
    condition += "; and not __fish_seen_subcommand_from " + spaced(names_below(command));
  return condition;
}

std::string fish_option(const OptionWords& option) {
  if (option.positional) return option.choices.empty() ? "" : " -f -a " + quoted(spaced(option.choices));
  std::string text;
  for (const std::string& name : option.names)
    text += name.compare(0, 2, "--") == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!option.choices.empty())
    text += " -x -a " + quoted(spaced(option.choices));
  else if (!option.value.empty())
    text += option.takes_file() ? " -r -F" : " -x";
  return text;
}

}  // namespace

std::string bash_completion(const CommandWords& program) {
  std::string paths, values, options;
  for (const CommandWords* command : all_commands(program)) {
    const std::string path = quoted(command->joined(" "));
    if (!command->path.empty()) paths += (paths.empty() ? "" : " | ") + path;
    values += bash_values(*command);
    options += fmt::format("        {}) options={} arguments={} ;;\n", path,
                           quoted(spaced(option_names(*command))), quoted(spaced(argument_words(*command))));
  }
  return fmt::format(R"(# Completion of mica in bash, made by `mica manual bash`.
_mica() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}
  local path= word words= options= arguments=
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD - 1}}"; do
    case "${{path:+$path }}$word" in
      {}) path=${{path:+$path }}$word ;;
    esac
  done
  case "$path $previous" in
{}    *)
      case $path in
{}      esac
      words=$arguments
      [[ $current != -* ]] || words=$options
      ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}}
complete -o bashdefault -o default -F _mica mica
)",
                     paths, values, options);
}

std::string zsh_completion(const CommandWords& program) {
  std::string functions;
  for (const CommandWords* command : all_commands(program))
    functions += fmt::format("\n{}() {{\n{}}}\n", zsh_function(*command), zsh_body(*command));
  return "#compdef mica\n# Completion of mica in zsh, made by `mica manual zsh`.\n" + functions +
         "\n_mica \"$@\"\n";
}

std::string fish_completion(const CommandWords& program) {
  std::string text = "# Completion of mica in fish, made by `mica manual fish`.\n";
  for (const CommandWords* command : all_commands(program)) {
    const std::string start = "complete -c mica -n " + quoted(fish_condition(*command));
    for (const CommandWords& below : command->commands)
      text += fmt::format("{} -f -a {} -d {}\n", start, below.name(), quoted(below.description));
    for (const OptionWords& option : command->options)
      if (const std::string words = fish_option(option); !words.empty())
        text += fmt::format("{}{} -d {}\n", start, words, quoted(option.description));
  }
  return text;
}

}  // namespace mica::host::app
