// mica._mica: the public library, class by class. What users see of it is in python/mica.
#include <cstdlib>

#include "python/src/bindings.h"

namespace mica::python {

Settings to_settings(const SettingTexts& texts) {
  Settings settings;
  for (const auto& [key, text] : texts) settings.emplace_back(key, text);
  return settings;
}

RunControl to_control(const CancellationToken& cancellation, nb::handle report) {
  RunControl control;
  control.cancellation = cancellation;
  if (!report.is_none())
    control.progress = [report](std::size_t done, std::size_t all) {
      const nb::gil_scoped_acquire acquire;
      report(done, all);
    };
  return control;
}

}  // namespace mica::python

NB_MODULE(_mica, module) {
  using namespace mica::python;
  // What a user's program still holds at its end is freed with the process; only tests want to hear of it.
  nb::set_leak_warnings(std::getenv("MICA_LEAK_WARNINGS") != nullptr);
  bind_errors(module);
  bind_devices(module);
  bind_maps(module);
  bind_evaluators(module);
  bind_brdfs(module);
  bind_jobs(module);
  bind_glints(module);
  bind_methods(module);
}
