#include "host/app/command_words.h"

#include <CLI/CLI.hpp>

namespace mica::host::app {
namespace {

/// "NAME:{a,b}" and "N:INT in [1 - 4]" are what CLI11 makes of a type's name and of what checks the value.
void read_type(const std::string& type, OptionWords* words) {
  const std::size_t colon = type.find(':');
  words->value = type.substr(0, colon);
  if (colon == std::string::npos) return;
  const std::string check = type.substr(colon + 1);
  if (check.size() > 1 && check.front() == '{' && check.back() == '}')
    words->choices = CLI::detail::split(check.substr(1, check.size() - 2), ',');
  else if (check.find("in [") != std::string::npos)
    words->range = check.substr(check.find("in ["));
}

/// Of a list, CLI11 shows "[0.3]", and "[]" of an empty one.
std::string usual_value(const std::string& text) {
  const bool list = text.size() > 1 && text.front() == '[' && text.back() == ']';
  return list ? text.substr(1, text.size() - 2) : text;
}

OptionWords describe_option(const CLI::Option& option) {
  OptionWords words;
  words.description = option.get_description();
  words.positional = option.get_positional();
  words.required = option.get_required();
  words.repeats = option.get_expected_max() == CLI::detail::expected_max_vector_size;
  if (words.positional) words.names.push_back(option.get_name(true, false));
  for (const std::string& name : option.get_snames()) words.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) words.names.push_back("--" + name);
  if (option.get_type_size() != 0) {
    read_type(option.get_type_name(), &words);
    words.usual = usual_value(option.get_default_str());
  }
  return words;
}

CommandWords describe_command(const CLI::App& app, const std::vector<std::string>& path) {
  CommandWords words{path, app.get_description(), app.get_footer(), {}, {}};
  for (const CLI::Option* option :
       app.get_options([](const CLI::Option* each) { return !each->get_group().empty(); }))
    words.options.push_back(describe_option(*option));
  for (const CLI::App* command :
       app.get_subcommands([](const CLI::App* each) { return !each->get_group().empty(); })) {
    std::vector<std::string> longer = path;
    longer.push_back(command->get_name());
    words.commands.push_back(describe_command(*command, longer));
  }
  return words;
}

}  // namespace

CommandWords describe_command_line(const CommandLine& app) {
  return describe_command(app.parsed(), {});
}

}  // namespace mica::host::app
