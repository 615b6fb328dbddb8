#include "mica/method.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "host/library/query.h"
#include "host/methods/evaluator.h"
#include "host/methods/oracle_standard.h"
#include "host/methods/ready_densities.h"
#include "host/methods/registry.h"
#include "host/methods/standard.h"
#include "host/reference/oracle.h"
#include "host/surface/surface.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// Numbers of a method from outside.
class OutsideSettings : public SettingsOf<OutsideSettings> {
 public:
  explicit OutsideSettings(std::vector<MethodNumber> numbers) : numbers_(std::move(numbers)) {}
  void visit(SettingVisitor& visitor) override {
    for (MethodNumber& n : numbers_) visitor.number(n.key.c_str(), n.help.c_str(), n.value, {n.low, n.high});
  }
  std::vector<double> values() const {
    std::vector<double> values;
    for (const MethodNumber& number : numbers_) values.push_back(number.value);
    return values;
  }

 private:
  std::vector<MethodNumber> numbers_;
};

class OutsideEvaluator : public Evaluator {
 public:
  OutsideEvaluator(std::string name, std::unique_ptr<mica::Method::Densities> densities, std::size_t bytes)
      : name_(std::move(name)), densities_(std::move(densities)), bytes_(bytes) {
    if (!densities_) throw UsageError(fmt::format("method \"{}\" made nothing that answers", name_));
  }

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override {
    constexpr std::size_t chunk = 256;
    std::vector<float> answers(queries.size());
    tbb::parallel_for(std::size_t{0}, (queries.size() + chunk - 1) / chunk, [&](std::size_t block) {
      const std::size_t first = block * chunk, count = std::min(chunk, queries.size() - first);
      std::vector<mica::Query> some(count);
      for (std::size_t n = 0; n < count; ++n) some[n] = to_public(queries[first + n]);
      densities_->evaluate({some.data(), count}, {answers.data() + first, count});
    });
    if (!std::all_of(answers.begin(), answers.end(), [](float d) { return std::isfinite(d) && d >= 0; }))
      throw DeviceError(fmt::format("evaluating {}: a density is not finite, or negative", name_));
    return std::make_unique<ReadyDensities>(std::move(answers));
  }
  std::string name() const override { return name_; }
  std::size_t device_bytes() const override { return bytes_; }
  double build_seconds() const override { return 0; }
  double device_seconds() const override { return 0; }

 private:
  std::string name_;
  std::unique_ptr<mica::Method::Densities> densities_;
  std::size_t bytes_;
};

/// A method from outside, as the library's own are seen.
class OutsideMethod : public Method {
 public:
  explicit OutsideMethod(std::shared_ptr<const mica::Method> method) : method_(std::move(method)) {}

  std::string name() const override { return method_->name(); }
  std::string summary() const override { return method_->summary(); }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.device = false;
    traits.first_order = method_->takes_first_order();
    return traits;
  }
  bool takes(Interpolation interpolation) const override {
    return method_->takes(static_cast<mica::Interpolation>(interpolation));
  }
  std::unique_ptr<MethodSettings> settings() const override {
    return std::make_unique<OutsideSettings>(method_->numbers());
  }
  StructureSize structure(const StructureAsked& asked, const MethodSettings&) const override {
    return {0, method_->bytes(asked.width, asked.height), "none"};
  }
  std::unique_ptr<Evaluator> make_own(Device*, const Surface* surface,
                                      const MethodSettings& settings) const override {
    if (!takes(surface->interpolation()))
      throw UsageError(fmt::format("{} does not take a surface of this interpolation", name()));
    const NormalMap map(std::make_shared<Surface>(*surface));  // the method may keep it
    return std::make_unique<OutsideEvaluator>(
        name(), method_->make(map, settings_as<OutsideSettings>(settings).values()),
        method_->bytes(surface->width(), surface->height()));
  }
  std::unique_ptr<Standard> standard(const Surface*, const reference::Oracle* map,
                                     const MethodSettings&) const override {
    const double error = method_->promised_error();
    return error > 0 ? std::make_unique<OracleStandard>(*map,
                                                        [error](double) {
                                                          return Promise{error, error};
                                                        })
                     : nullptr;
  }

 private:
  std::shared_ptr<const mica::Method> method_;
};

bool is_word(const std::string& name) {
  return !name.empty() && std::islower(static_cast<unsigned char>(name.front())) &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::islower(c) || std::isdigit(c) || c == '_'; });
}

}  // namespace
}  // namespace mica::host

MICA_BEGIN_NAMESPACE

Method::~Method() = default;
Method::Densities::~Densities() = default;

Methods::Methods()
    : implementation_(std::make_shared<host::MethodRegistry>(host::MethodRegistry::builtin())) {}

void Methods::add(std::shared_ptr<const Method> method) {
  if (!method) throw UsageError("method: found none; expected one to add");
  const std::string name = method->name();
  if (!host::is_word(name))
    throw UsageError(fmt::format("method \"{}\": expected a name of lower-case letters, digits and _", name));
  auto copy =
      std::make_shared<host::MethodRegistry>(*implementation_);  // others may hold the one that there is
  copy->add(std::make_shared<host::OutsideMethod>(std::move(method)));
  implementation_ = std::move(copy);
}

std::vector<std::string> Methods::names() const {
  return implementation_->names([](const host::MethodTraits&) { return true; });
}

MethodInfo Methods::info(const std::string& name) const {
  const host::Method& method = implementation_->get(name);
  const host::MethodTraits traits = method.traits();
  return {name, method.summary(), traits.map, traits.densities, traits.brdf, traits.keeps_tolerance};
}

std::vector<std::string> Methods::settings_of(const std::string& name) const {
  std::vector<std::string> lines;
  for (const host::SettingEntry& entry : host::list_settings(*implementation_->get(name).settings()))
    lines.push_back(fmt::format("{} = {}: {}", entry.key, entry.value, entry.help));
  return lines;
}

MICA_END_NAMESPACE
