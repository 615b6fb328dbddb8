#include <fmt/format.h>

#include "host/app/manual.h"
#include "mica/version.h"

namespace mica::host::app {
namespace {

/// Text as roff reads it back: no line is a request, no hyphen becomes a typographic one.
std::string roff(const std::string& text) {
  std::string escaped;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) escaped += "\\&";
    if (c == '\\')
      escaped += "\\e";
    else if (c == '-')
      escaped += "\\-";
    else
      escaped += c;
    line_begins = c == '\n';
  }
  return escaped;
}

/// `\fBbold\fR`
std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}

std::string italic(const std::string& text) {
  return "\\fI" + roff(text) + "\\fR";
}

/// "-o, --output FILE" with its description and what else there is to know.
std::string option_entry(const OptionWords& option) {
  std::string names, facts;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ", ") + (option.positional ? italic(name) : bold(name));
  if (!option.positional && !option.value.empty()) names += " " + italic(option.value);
  if (!option.choices.empty()) facts += fmt::format(" One of {}.", fmt::join(option.choices, ", "));
  if (!option.range.empty()) facts += fmt::format(" A number {}.", option.range);
  if (!option.usual.empty()) facts += fmt::format(" Default: {}.", option.usual);
  if (option.required && !option.positional) facts += " Required.";
  const bool open = !option.description.empty() && option.description.back() != '.';
  return fmt::format(".TP\n{}\n{}{}\n", names, roff(option.description), roff((open ? "." : "") + facts));
}

std::string synopsis(const CommandWords& command) {
  std::string text = bold("mica " + command.joined(" "));
  for (const OptionWords& option : command.options)
    if (option.required && !option.positional)
      text += " " + bold(option.names.back()) + " " + italic(option.value);
  text += " [" + italic("option") + " ...]";
  for (const OptionWords& option : command.options)
    if (option.positional)
      text += option.required ? " " + italic(option.names[0]) : " [" + italic(option.names[0]) + "]";
  return text;
}

/// A section for each command that does something; `map` itself does not, its kinds do.
std::string command_sections(const CommandWords& command) {
  std::string text;
  if (!command.path.empty()) {
    text += fmt::format(".SS mica {}\n", roff(command.joined(" ")));
    if (command.commands.empty()) text += synopsis(command) + "\n.PP\n";
    text += roff(command.description) + ".\n";
    for (const OptionWords& option : command.options) text += option_entry(option);
    if (!command.footer.empty()) text += ".PP\n.nf\n" + roff(command.footer) + "\n.fi\n";
  }
  for (const CommandWords& below : command.commands) text += command_sections(below);
  return text;
}

constexpr const char* kRest = R"(.SH EXIT STATUS
.TP
0
All was done.
.TP
1
Some images failed.
.TP
2
The command line, the job or a query table is wrong.
.TP
3
An OpenCL device is missing or failed.
.TP
4
A file cannot be read, is damaged or cannot be written.
.TP
130, 143
Stopped by a signal; nothing unfinished was written.
.SH ENVIRONMENT
.TP
.B XDG_CACHE_HOME
Compiled kernels are kept in its folder mica; default: ~/.cache.
.TP
.B POCL_CACHE_DIR
Where PoCL, which makes an OpenCL device of a CPU, keeps its own.
.TP
.B OCL_ICD_VENDORS
Folder of the .icd files that name the OpenCL platforms; default: /etc/OpenCL/vendors.
.SH EXAMPLES
.TP
.B mica check first.toml
Says what the job will take, and does nothing else.
.TP
.B mica render first.toml \-\-set image.width=1920 \-o first.exr
Renders it wider, into first.exr and first.png.
.TP
.B mica map flakes \-\-flake\-size 8 \-o flakes.exr
Makes a normal map of metallic flakes.
.SH SEE ALSO
.BR clinfo (1)
)";

}  // namespace

std::string man_page(const CommandWords& program) {
  std::string text = fmt::format(".TH MICA 1 \"\" \"Mica {}\" \"User Commands\"\n", version());
  text += ".nh\n.ad l\n.SH NAME\nmica \\- glint normal distribution functions in large batches on OpenCL\n";
  text += ".SH SYNOPSIS\n";
  for (const CommandWords& command : program.commands)
    text += fmt::format("{} ...\n.br\n", bold("mica " + command.name()));
  text += ".SH DESCRIPTION\n" + roff(program.description);
  text += "\nData goes to the standard output, log and progress to the standard error.\n.SH OPTIONS\n";
  for (const OptionWords& option : program.options) text += option_entry(option);
  return text + ".SH COMMANDS\n" + command_sections(program) + kRest;
}

}  // namespace mica::host::app
