#include "host/methods/method.h"

#include <fmt/format.h>

#include <cmath>

#include "host/methods/evaluator.h"
#include "host/methods/finite_brdf.h"
#include "host/methods/finite_evaluator.h"
#include "host/methods/map/map_query.h"
#include "host/methods/patch_brdf.h"
#include "host/methods/standard.h"
#include "host/surface/surface.h"
#include "mica/error.h"

namespace mica::host {

std::unique_ptr<MethodSettings> Method::settings() const {
  return std::make_unique<NoSettings>();
}

void Method::check(const MethodSettings& settings) const {
  if (settings.tolerance && !traits().keeps_tolerance)
    throw UsageError(fmt::format("tolerance {}: {} promises no error", *settings.tolerance, name()));
}

bool Method::share(const MethodSettings& a, const MethodSettings& b, bool) const {
  return describe(a) == describe(b) && a.tolerance == b.tolerance;
}

std::unique_ptr<Evaluator> Method::make(Device* device, const Surface* surface,
                                        const MethodSettings& settings) const {
  return with_finite_answers(make_own(device, surface, settings), surface);
}

std::unique_ptr<Evaluator> Method::make_own(Device*, const Surface*, const MethodSettings&) const {
  refuse_densities();
}

std::unique_ptr<PatchBrdf> Method::make_brdf(Device* device, const Surface* surface,
                                             const MethodSettings& settings) const {
  if (surface != nullptr && surface->lobe_variance() > 0)
    throw UsageError(fmt::format(
        "precision \"widen\": the BRDF of {} takes its lobes as they are; say a roughness that is wider by "
        "{:.2g}, in squares",
        name(), std::sqrt(surface->lobe_variance())));
  return with_finite_answers(make_own_brdf(device, surface, settings));
}

std::unique_ptr<PatchBrdf> Method::make_own_brdf(Device*, const Surface*, const MethodSettings&) const {
  refuse_brdf();
}

std::string Method::query_problem(const Query& query, const Surface* surface) const {
  if (has_first_order(query) && !traits().first_order)
    return fmt::format("{} takes no turn of the half vector and no lobe that is not round", name());
  return own_query_problem(query, surface);
}

std::string Method::own_query_problem(const Query& query, const Surface* surface) const {
  return host::query_problem(query, surface->width(), surface->height());
}

std::unique_ptr<Standard> Method::standard(const Surface*, const reference::Oracle*,
                                           const MethodSettings&) const {
  return nullptr;
}

std::vector<MethodVariant> Method::variants(const std::vector<int>&) const {
  std::vector<MethodVariant> all;
  all.push_back({settings(), name(), ""});
  return all;
}

OperationCounter Method::counter(Device*, const Surface*, const MethodSettings&) const {
  return {};
}

void Method::refuse_brdf() const {
  throw UsageError(fmt::format("\"{}\" has no BRDF of its own", name()));
}

void Method::refuse_densities() const {
  throw UsageError(fmt::format("\"{}\" has no density; it answers for its BRDF alone", name()));
}

std::string view_problem(const Method& method, const ViewQuery& query, const Surface* surface) {
  return method.query_problem({query.footprint, Eigen::Vector2d::Zero(), query.roughness}, surface);
}

void refuse_settings() {
  throw UsageError("settings: found those of another method; expected those that the method itself made");
}

}  // namespace mica::host
