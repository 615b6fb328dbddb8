#include "host/methods/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/methods/evaluator.h"
#include "host/methods/patch_brdf.h"
#include "mica/error.h"

/// Every method, in the order of lists and benchmarks. Each defines `NAME_method` in host/methods/NAME/.
#define MICA_METHODS(METHOD) \
  METHOD(triangles)          \
  METHOD(gaussians)          \
  METHOD(beckmanns)          \
  METHOD(smooth)             \
  METHOD(cavities)           \
  METHOD(pyramid)            \
  METHOD(auto)               \
  METHOD(grid)               \
  METHOD(normalmap)          \
  METHOD(reference)

namespace mica::host {

#define MICA_DECLARE(name) std::shared_ptr<const Method> name##_method();
MICA_METHODS(MICA_DECLARE)
#undef MICA_DECLARE

MethodRegistry MethodRegistry::builtin() {
  MethodRegistry registry;
#define MICA_ADD(name) registry.add(name##_method());
  MICA_METHODS(MICA_ADD)
#undef MICA_ADD
  return registry;
}

void MethodRegistry::add(std::shared_ptr<const Method> method) {
  if (find(method->name()) != nullptr)
    throw UsageError(
        fmt::format("method \"{}\": found two of that name; expected another name", method->name()));
  methods_.push_back(std::move(method));
}

const Method* MethodRegistry::find(const std::string& name) const {
  for (const auto& method : methods_)
    if (method->name() == name) return method.get();
  return nullptr;
}

const Method& MethodRegistry::get(const std::string& name) const {
  if (const Method* const method = find(name)) return *method;
  const auto any = [](const MethodTraits&) { return true; };
  throw UsageError(
      fmt::format("there is no method \"{}\"; available: {}", name, fmt::join(names(any), ", ")));
}

std::vector<std::string> MethodRegistry::names(const Wanted& is_wanted) const {
  std::vector<std::string> list;
  for (const auto& method : methods_)
    if (is_wanted(method->traits())) list.push_back(method->name());
  return list;
}

namespace {

std::unique_ptr<MethodSettings> settings_of(const Method& method, const SettingTexts& texts) {
  std::unique_ptr<MethodSettings> settings = method.settings();
  read_settings(texts, settings.get());
  method.check(*settings);
  return settings;
}

}  // namespace

std::unique_ptr<Evaluator> make_evaluator(const std::string& name, Device& device, const Surface& surface,
                                          const SettingTexts& settings) {
  const MethodRegistry methods = MethodRegistry::builtin();
  const Method& method = methods.get(name);
  return method.make(&device, &surface, *settings_of(method, settings));
}

std::unique_ptr<PatchBrdf> make_patch_brdf(const std::string& name, Device& device, const Surface& surface,
                                           const SettingTexts& settings) {
  const MethodRegistry methods = MethodRegistry::builtin();
  const Method& method = methods.get(name);
  return method.make_brdf(&device, &surface, *settings_of(method, settings));
}

}  // namespace mica::host
