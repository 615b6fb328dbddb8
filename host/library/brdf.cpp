#include "mica/brdf.h"

#include <fmt/format.h>

#include <mutex>

#include "host/base/chunks.h"
#include "host/base/random.h"
#include "host/library/query.h"
#include "host/library/settings.h"
#include "host/library/subject.h"
#include "host/library/work.h"
#include "host/methods/patch_brdf.h"

MICA_BEGIN_NAMESPACE

class Brdf::Implementation {
 public:
  Implementation(const Device& device, std::shared_ptr<const host::Surface> surface, const std::string& name,
                 const Settings& settings, const Methods& methods)
      : subject_(device, std::move(surface), name, methods),
        brdf_(subject_.method().make_brdf(subject_.device(), subject_.surface(),
                                          *host::method_settings(subject_.method(), settings))) {}

  /// Answers of all questions, `take(number, answer)` one by one, after all were found to have an answer.
  template <typename Question, typename Answer, typename Ask, typename Take>
  void answer(std::size_t count, const RunControl& control,
              std::vector<Answer> (host::PatchBrdf::*answers)(const std::vector<Question>&), const Ask& ask,
              const Take& take) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto work = [&](std::size_t first, std::size_t some) {
      std::vector<Question> questions(some);
      for (std::size_t n = 0; n < some; ++n) questions[n] = ask(first + n);
      const std::vector<Answer> results = ((*brdf_).*answers)(questions);
      for (std::size_t n = 0; n < some; ++n) take(first + n, results[n]);
    };
    host::work_in_chunks(count, work, [&](std::size_t done) { host::report(control, done, count); });
  }

  /// A view is checked like a query, whose half vector does not matter.
  void check(const Views& views) const {
    subject_.check(views.count, [&](std::size_t n) {
      const host::ViewQuery view = host::to_view(views, n);
      return host::Query{view.footprint, Eigen::Vector2d::Zero(), view.roughness};
    });
  }
  host::PatchBrdf& brdf() { return *brdf_; }

 private:
  std::mutex mutex_;
  host::Subject subject_;
  std::unique_ptr<host::PatchBrdf> brdf_;  // goes before what it stands on
};

Brdf::Brdf(const Device& device, const NormalMap& map, const std::string& method, const Settings& settings,
           const Methods& methods)
    : implementation_(
          std::make_shared<Implementation>(device, map.implementation(), method, settings, methods)) {}

Brdf::Brdf(const Device& device, const std::string& method, const Settings& settings, const Methods& methods)
    : implementation_(std::make_shared<Implementation>(device, nullptr, method, settings, methods)) {}

namespace {

float part_of(const host::BrdfValue& value, BrdfPart part) {
  if (part == BrdfPart::single) return value.single;
  return part == BrdfPart::multiple ? value.multiple : value.single + value.multiple;
}

void check_views(const Views& views, const Brdf::Implementation& implementation) {
  host::check_columns(views);
  for (const Column* column : {&views.ox, &views.oy, &views.oz, &views.roughness})
    if (views.count > 0 && column->is_null())
      throw UsageError("queries: found a column without memory; expected numbers");
  implementation.check(views);
}

}  // namespace

void Brdf::evaluate(const Lightings& queries, Span<float> values, BrdfPart part,
                    const RunControl& control) const {
  Implementation& implementation = host::opened(implementation_);
  host::check_room(queries.count, values, "values");
  check_views(queries, implementation);
  for (const Column* column : {&queries.ix, &queries.iy, &queries.iz})
    if (queries.count > 0 && column->is_null())
      throw UsageError("queries: found a column without memory; expected numbers");
  for (std::size_t n = 0; n < queries.count; ++n) host::to_lighting(queries, n);
  implementation.answer<host::BrdfQuery, host::BrdfValue>(
      queries.count, control, &host::PatchBrdf::evaluate,
      [&](std::size_t n) { return host::to_lighting(queries, n); },
      [&](std::size_t n, const host::BrdfValue& value) { values[n] = part_of(value, part); });
}

void Brdf::energy(const Views& views, Span<float> albedos, const RunControl& control) const {
  Implementation& implementation = host::opened(implementation_);
  host::check_room(2 * views.count, albedos, "albedos");
  check_views(views, implementation);
  implementation.answer<host::ViewQuery, host::Albedo>(
      views.count, control, &host::PatchBrdf::energy, [&](std::size_t n) { return host::to_view(views, n); },
      [&](std::size_t n, const host::Albedo& albedo) {
        albedos[2 * n] = albedo.single, albedos[2 * n + 1] = albedo.lost;
      });
}

void Brdf::sample(const Views& views, std::uint64_t seed, Span<float> samples,
                  const RunControl& control) const {
  Implementation& implementation = host::opened(implementation_);
  host::check_room(5 * views.count, samples, "samples");
  check_views(views, implementation);
  implementation.answer<host::SampleQuery, host::BrdfSample>(
      views.count, control, &host::PatchBrdf::sample,
      [&](std::size_t n) {
        return host::SampleQuery{host::to_view(views, n), host::random_bits(seed, 0, n)};
      },
      [&](std::size_t n, const host::BrdfSample& sample) {
        const float numbers[] = {sample.light.x(), sample.light.y(), sample.light.z(), sample.pdf,
                                 sample.weight_single + sample.weight_multiple};
        std::copy(std::begin(numbers), std::end(numbers), samples.data + 5 * n);
      });
}

std::string Brdf::method() const {
  return host::opened(implementation_).brdf().name();
}

std::size_t Brdf::device_bytes() const {
  return host::opened(implementation_).brdf().device_bytes();
}

double Brdf::build_seconds() const {
  return host::opened(implementation_).brdf().build_seconds();
}

double Brdf::device_seconds() const {
  return host::opened(implementation_).brdf().device_seconds();
}

MICA_END_NAMESPACE
