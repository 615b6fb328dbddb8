#include "host/job/read_surface.h"

#include "host/job/read_job.h"
#include "host/job/toml_document.h"

namespace mica::host {

SurfaceDescription read_surface(const std::vector<std::pair<std::string, std::string>>& keys) {
  Issues issues("");
  toml::table root;
  for (const auto& [key, value] : keys) apply_override(root, "surface.map." + key + "=" + value, issues);
  std::vector<SurfaceDescription> surfaces;
  ReadContext context{issues, {}};
  TableReader::read_root(root, context, [&](TableReader& table) { surfaces = read_surfaces(table); });
  try {
    issues.throw_if_any();
  } catch (const JobError& error) {
    std::string text;
    for (const JobIssue& issue : error.issues()) text += (text.empty() ? "" : "\n") + issue.message;
    throw UsageError(text);
  }
  if (surfaces.empty()) throw UsageError("surface: found none; expected `file` or `generate`");
  return surfaces.front();
}

}  // namespace mica::host
