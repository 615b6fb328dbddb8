#include "host/app/command_line.h"

#include <CLI/CLI.hpp>

#include "host/app/exit_code.h"

namespace mica::host::app {

Values one_of(std::vector<std::string> names) {
  return {std::move(names), {}, {}};
}

Values between(int low, int high) {
  return {{}, std::make_pair(low, high), {}};
}

Values between(double low, double high) {
  return {{}, {}, std::make_pair(low, high)};
}

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::type_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option& Option::check(const Values& values) {
  if (!values.names.empty()) option_->check(CLI::IsMember(values.names));
  if (values.whole) option_->check(CLI::Range(values.whole->first, values.whole->second));
  if (values.real) option_->check(CLI::Range(values.real->first, values.real->second));
  return *this;
}

Option& Option::show_default() {
  option_->capture_default_str();
  return *this;
}

Option& Option::group(const std::string& title) {
  option_->group(title);
  return *this;
}

Option& Option::numbers(char delimiter, int fewest, int most) {
  option_->delimiter(delimiter)->expected(fewest, most);
  return *this;
}

Option& Option::repeated() {
  option_->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return *this;
}

CommandLine::CommandLine(const std::string& description)
    : app_(nullptr), own_(std::make_unique<CLI::App>(description)) {
  app_ = own_.get();
}

CommandLine::CommandLine(CLI::App* app) : app_(app) {}

CommandLine::~CommandLine() = default;

CommandLine* CommandLine::add_subcommand(const std::string& name, const std::string& description) {
  subcommands_.push_back(
      std::unique_ptr<CommandLine>(new CommandLine(app_->add_subcommand(name, description))));
  return subcommands_.back().get();
}

void CommandLine::require_subcommand() {
  app_->require_subcommand(1);
}

void CommandLine::footer(const std::string& text) {
  app_->footer(text);
}

void CommandLine::version_flag(const std::string& name, std::function<std::string()> version) {
  app_->set_version_flag(name, std::move(version));
}

void CommandLine::hide() {
  app_->group("");
}

void CommandLine::callback(std::function<void()> chosen) {
  app_->callback(std::move(chosen));
}

Option CommandLine::add_option(const std::string& name, std::string& value, const std::string& description) {
  return Option(app_->add_option(name, value, description));
}

Option CommandLine::add_option(const std::string& name, int& value, const std::string& description) {
  return Option(app_->add_option(name, value, description));
}

Option CommandLine::add_option(const std::string& name, std::uint32_t& value,
                               const std::string& description) {
  return Option(app_->add_option(name, value, description));
}

Option CommandLine::add_option(const std::string& name, std::uint64_t& value,
                               const std::string& description) {
  return Option(app_->add_option(name, value, description));
}

Option CommandLine::add_option(const std::string& name, double& value, const std::string& description) {
  return Option(app_->add_option(name, value, description));
}

Option CommandLine::add_option(const std::string& name, std::optional<double>& value,
                               const std::string& description) {
  return Option(app_->add_option(name, value, description));
}

Option CommandLine::add_option(const std::string& name, std::vector<double>& values,
                               const std::string& description) {
  return Option(app_->add_option(name, values, description));
}

Option CommandLine::add_option(const std::string& name, std::vector<std::string>& values,
                               const std::string& description) {
  return Option(app_->add_option(name, values, description));
}

Option CommandLine::add_option(const std::string& name, const std::function<void(const std::string&)>& take,
                               const std::string& description) {
  return Option(app_->add_option_function<std::string>(name, take, description));
}

Option CommandLine::add_flag(const std::string& name, bool& value, const std::string& description) {
  return Option(app_->add_flag(name, value, description));
}

Option CommandLine::option(const std::string& name) {
  return Option(app_->get_option(name));
}

std::optional<int> CommandLine::parse(int argc, const char* const* argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app_->exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  }
  return std::nullopt;
}

}  // namespace mica::host::app
