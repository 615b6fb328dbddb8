#include "python/src/bindings.h"

namespace mica::python {
namespace {

int run_as_program(const std::vector<nb::bytes>& arguments) {
  std::vector<const char*> words;
  for (const nb::bytes& argument : arguments) words.push_back(argument.c_str());
  words.push_back(nullptr);
  return without_gil([&] { return run_program(static_cast<int>(arguments.size()), words.data()); });
}

}  // namespace

void bind_methods(nb::module_& module) {
  nb::class_<MethodInfo>(module, "MethodInfo")
      .def_ro("name", &MethodInfo::name)
      .def_ro("summary", &MethodInfo::summary)
      .def_ro("needs_map", &MethodInfo::needs_map)
      .def_ro("has_densities", &MethodInfo::has_densities)
      .def_ro("has_brdf", &MethodInfo::has_brdf)
      .def_ro("keeps_tolerance", &MethodInfo::keeps_tolerance);
  module.def("method_names", [] { return Methods().names(); });
  module.def(
      "method_info", [](const std::string& name) { return Methods().info(name); }, nb::arg("name"));
  module.def("version", &version);
  module.def("run_program", &run_as_program, nb::arg("arguments"));
}

}  // namespace mica::python
