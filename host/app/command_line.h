#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace mica::host::app {

// The command line as Mica's commands see it. CLI11 behind it takes ten seconds to compile in each source
// that names it; so one source does.

/// Which values an option takes; the help says so.
struct Values {
  std::vector<std::string> names;
  std::optional<std::pair<int, int>> whole;       ///< from, to
  std::optional<std::pair<double, double>> real;  ///< from, to
};
Values one_of(std::vector<std::string> names);
Values between(int low, int high);
Values between(double low, double high);

/// An option that was added; as many of these as apply may follow each other.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option& required();
  Option& type_name(const std::string& name);
  Option& check(const Values& values);
  Option& show_default();  ///< in the help
  Option& group(const std::string& title);
  Option& numbers(char delimiter, int fewest, int most);  ///< "1,2,3" in one argument
  Option& repeated();                                     ///< once for each value

 private:
  CLI::Option* option_;
};

/// The program, or one of its subcommands, with its options.
class CommandLine {
 public:
  explicit CommandLine(const std::string& description);
  ~CommandLine();

  CommandLine* add_subcommand(const std::string& name, const std::string& description);
  void require_subcommand();
  void footer(const std::string& text);
  void version_flag(const std::string& name, std::function<std::string()> version);
  void hide();  ///< from the help
  void callback(
      std::function<void()> chosen);  ///< when this subcommand is called, after its options were read

  /// @param name "--name", "-n,--name", or "name" of an argument without. @param value has to outlive the
  /// command line.
  Option add_option(const std::string& name, std::string& value, const std::string& description);
  Option add_option(const std::string& name, int& value, const std::string& description);
  Option add_option(const std::string& name, std::uint32_t& value, const std::string& description);
  Option add_option(const std::string& name, std::uint64_t& value, const std::string& description);
  Option add_option(const std::string& name, double& value, const std::string& description);
  Option add_option(const std::string& name, std::optional<double>& value, const std::string& description);
  Option add_option(const std::string& name, std::vector<double>& values, const std::string& description);
  Option add_option(const std::string& name, std::vector<std::string>& values,
                    const std::string& description);
  /// @param take gets the text when the option is given.
  Option add_option(const std::string& name, const std::function<void(const std::string&)>& take,
                    const std::string& description);
  Option add_flag(const std::string& name, bool& value, const std::string& description);
  Option option(const std::string& name);

  /// Nothing, or the exit code after the help, the version or a message about a mistake was printed.
  std::optional<int> parse(int argc, const char* const* argv);

  /// As CLI11 has it, for what describes the whole command line.
  const CLI::App& parsed() const { return *app_; }

 private:
  explicit CommandLine(CLI::App* app);
  CLI::App* app_;
  std::unique_ptr<CLI::App> own_;  ///< of the program
  std::vector<std::unique_ptr<CommandLine>> subcommands_;
};

}  // namespace mica::host::app
