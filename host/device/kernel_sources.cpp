#include "host/device/kernel_sources.h"

#include <fmt/format.h>

#include <set>
#include <sstream>

#include "mica/error.h"

namespace mica::host {
namespace {

bool has_include_guard(const std::string& text) {
  return text.find("_H\n#define ") != std::string::npos;
}

void expand(const std::string& name, std::set<std::string>* included, std::string* out) {
  const auto found = kernel_sources().find(name);
  if (found == kernel_sources().end())
    throw DeviceError("kernel source " + name + ": no such file in kernels/");
  if (!included->insert(name).second && has_include_guard(found->second)) return;
  std::istringstream lines(found->second);
  std::string line;
  *out += fmt::format("#line 1 \"{}\"\n", name);
  const std::string directive = "#include \"";
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.compare(0, directive.size(), directive) == 0) {
      expand(line.substr(directive.size(), line.find('"', directive.size()) - directive.size()), included,
             out);
      *out += fmt::format("#line {} \"{}\"\n", number + 1, name);
    } else {
      *out += line + '\n';
    }
  }
}

}  // namespace

std::string expand_kernel_source(const std::string& name) {
  std::set<std::string> included;
  std::string source;
  expand(name, &included, &source);
  return source;
}

}  // namespace mica::host
