// The manual page and the completions say what `--help` says, of every command.
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "tests/app/command.h"

namespace mica::host::app::manual_test {
namespace {

/// What a command's help offers: names of options, and of the commands below it.
struct Help {
  std::set<std::string> options, commands;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

Help read_help(const std::string& text) {
  Help help;
  bool commands = false;
  std::smatch match;
  for (const std::string& line : lines_of(text)) {
    if (!line.empty() && line[0] != ' ') commands = line == "Subcommands:";
    if (std::regex_search(line, match, std::regex("^  (-[^ ]*)"))) {
      const std::string names = match[1];
      const std::regex each("[^,]+");
      for (std::sregex_token_iterator name(names.begin(), names.end(), each), end; name != end; ++name)
        help.options.insert(*name);
    } else if (commands && std::regex_search(line, match, std::regex("^  ([a-z]+)"))) {
      help.commands.insert(match[1]);
    }
  }
  return help;
}

/// The part of `text` from the line `start` up to the next line that begins with `stop`.
std::string part(const std::string& text, const std::string& start, const std::string& stop) {
  const std::size_t begin = text.find(start + "\n");
  if (begin == std::string::npos) return "";
  const std::size_t end = text.find("\n" + stop, begin + start.size());
  return text.substr(begin, end == std::string::npos ? end : end + 1 - begin);
}

std::string replaced(const std::string& text, const std::string& from, const std::string& to) {
  return std::regex_replace(text, std::regex(from), to);
}

class Manual : public CommandTest {
 protected:
  /// The help of every command, by its path: "", "eval", "map spectrum".
  std::map<std::string, Help> helps(const std::string& path = "") const {
    const Help help = read_help(mica(path + " --help").out);
    std::map<std::string, Help> all = {{path, help}};
    for (const std::string& name : help.commands) all.merge(helps(path.empty() ? name : path + " " + name));
    return all;
  }

  std::string manual(const std::string& form) const {
    const Outcome outcome = mica("manual " + form);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.out;
  }

  /// What bash offers after `words`, the last of which is being typed.
  std::set<std::string> bash_offers(const std::string& words) const {
    write("completion", manual("bash"));
    write("ask", "source ./completion\nCOMP_WORDS=(mica " + words +
                     ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_mica\n"
                     "printf '%s\\n' \"${COMPREPLY[@]}\" > offers\n");
    EXPECT_EQ(std::system(("cd '" + folder_.string() + "' && bash -eu ./ask").c_str()), 0) << words;
    const std::vector<std::string> lines = lines_of(bytes(path("offers")));
    return {lines.begin(), lines.end()};
  }
};

TEST_F(Manual, PageHasEveryOption) {
  const std::string page = manual("man");
  const std::map<std::string, Help> all = helps();
  EXPECT_GE(all.size(), 17u);
  for (const auto& [command, help] : all) {
    const std::string section =
        command.empty() ? part(page, ".SH OPTIONS", ".SH") : part(page, ".SS mica " + command, ".S");
    EXPECT_FALSE(help.options.empty()) << command;
    for (const std::string& option : help.options)
      EXPECT_NE(section.find("\\fB" + replaced(option, "-", "\\-") + "\\fR"), std::string::npos)
          << command << " " << option;
  }
}

TEST_F(Manual, BashOffersWhatTheHelpHas) {
  for (const auto& [command, help] : helps()) {
    EXPECT_EQ(bash_offers(command + " -"), help.options) << command;
    if (help.commands.empty()) continue;
    EXPECT_EQ(bash_offers(command + " ''"), help.commands) << command;
  }
}

TEST_F(Manual, BashOffersChoices) {
  EXPECT_EQ(bash_offers("eval --green ''"), (std::set<std::string>{"down", "up"}));
  EXPECT_EQ(bash_offers("ndf --map x.exr --interpolation bi"),
            (std::set<std::string>{"bicubic", "bilinear"}));
  EXPECT_EQ(bash_offers("bench ''"), (std::set<std::string>{"quick", "standard", "tiny"}));
  EXPECT_EQ(bash_offers("eval --queries ''"), (std::set<std::string>{""}));  // files are bash's own
}

TEST_F(Manual, ZshHasEveryOption) {
  const std::string completion = manual("zsh");
  for (const auto& [command, help] : helps()) {
    const std::string name = command.empty() ? "_mica" : "_mica_" + replaced(command, " ", "_");
    const std::string function = part(completion, name + "() {", "}");
    for (const std::string& option : help.options)
      EXPECT_NE(function.find(option + "["), std::string::npos) << command << " " << option;
    for (const std::string& below : help.commands)
      EXPECT_NE(function.find("'" + below + ":"), std::string::npos) << command << " " << below;
  }
}

TEST_F(Manual, FishHasEveryOption) {
  std::map<std::string, std::string> lines;  // of a command, by its condition
  std::smatch match;
  for (const std::string& line : lines_of(manual("fish")))
    if (std::regex_search(line, match, std::regex("-n '([^']*)'(.*)")))
      lines[match[1]] += match[2].str() + " \n";
  for (const auto& [command, help] : helps()) {
    std::string condition = "__fish_use_subcommand";
    if (!command.empty()) {
      condition =
          "__fish_seen_subcommand_from " + replaced(command, " ", "; and __fish_seen_subcommand_from ");
      if (!help.commands.empty()) {  // none of which is there
        const auto found = lines.lower_bound(condition + "; and not ");
        ASSERT_NE(found, lines.end()) << command;
        condition = found->first;
      }
    }
    for (const std::string& option : help.options) {
      const std::string word =
          option.rfind("--", 0) == 0 ? " -l " + option.substr(2) : " -s " + option.substr(1);
      EXPECT_NE(lines[condition].find(word + " "), std::string::npos) << command << " " << option;
    }
  }
}

TEST_F(Manual, VersionNamesCommitCompilerAndPlatforms) {
  const Outcome outcome = mica("--version");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(std::regex_match(outcome.out,
                               std::regex("mica [0-9]+\\.[0-9]+\\.[0-9]+ \\(commit ([0-9a-f]{7,}|unknown), "
                                          "(g|clang)\\+\\+ [0-9][^;]*; .+\\)\n")))
      << outcome.out;
  ASSERT_EQ(mica("devices --json devices.json").code, 0);
  const auto report = nlohmann::json::parse(bytes(path("devices.json")));
  for (const nlohmann::json& device : report.at("devices"))
    EXPECT_NE(outcome.out.find(device.at("platform").get<std::string>() + ", OpenCL "), std::string::npos)
        << outcome.out;
}

TEST_F(Manual, VersionNeedsNoPlatform) {
  const Outcome outcome = mica("--version", "OCL_ICD_VENDORS=/nonexistent");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("; no OpenCL platform)"), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace mica::host::app::manual_test
