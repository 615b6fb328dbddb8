// mica manual: the text of the manual page and of the shells' completions; hidden, for packages.
#include "host/app/manual.h"

#include <fmt/format.h>

#include <map>

#include "host/app/commands.h"

namespace mica::host::app {
namespace {

using ManualText = std::string (*)(const CommandWords&);

const std::map<std::string, ManualText>& manual_texts() {
  static const std::map<std::string, ManualText> texts = {
      {"man", man_page}, {"bash", bash_completion}, {"zsh", zsh_completion}, {"fish", fish_completion}};
  return texts;
}

}  // namespace

void add_manual(CommandLine& app, Command* chosen, const MethodRegistry& /*methods*/) {
  auto form = std::make_shared<std::string>();
  CommandLine* command =
      app.add_subcommand("manual", "Prints the manual page, or what completes it in a shell");
  command->hide();
  std::vector<std::string> names;
  for (const auto& [name, text] : manual_texts()) names.push_back(name);
  command->add_option("form", *form, "man, bash, zsh or fish").required().check(one_of(names));
  command->callback([form, chosen, &app] {
    *chosen = [form, &app] {
      fmt::print("{}", manual_texts().at(*form)(describe_command_line(app)));
      return 0;
    };
  });
}

}  // namespace mica::host::app
