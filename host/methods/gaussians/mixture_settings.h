#pragma once

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/methods/gaussians/mixture.h"
#include "host/methods/map/map_query.h"
#include "host/methods/method.h"
#include "host/methods/standard.h"

namespace mica::host {

inline void visit_elements(SettingVisitor& visitor, int& elements) {
  visitor.whole("elements", "Elements of a mixture, a texel and axis: more are slower and closer to the map",
                elements, 1, kMaxElements);
}

/// Settings of methods whose mixtures have elements.
class ElementSettings : public SettingsOf<ElementSettings> {
 public:
  void visit(SettingVisitor& visitor) override { visit_elements(visitor, elements); }

  int elements = 1;
};

/// A method once for each number of elements, as benchmarks show it.
template <typename Settings>
std::vector<MethodVariant> element_variants(const std::string& method, const std::vector<int>& elements) {
  std::vector<MethodVariant> all;
  for (const int count : elements) {
    auto settings = std::make_unique<Settings>();
    settings->elements = count;
    all.push_back({std::move(settings), fmt::format("{}, {} a texel and axis", method, count),
                   fmt::format("{}", count)});
  }
  return all;
}

/// Of the footprint's brightest: what culling drops of a mixture, twice its cutoff, and rounding.
constexpr double kMixtureDrops = 2e-4;

/// Far wider than a period, a footprint sees every part of the map alike: one of two periods does as well, to
/// exp(-8 pi^2), and its plain sum ends.
inline Query without_far_periods(Query query) {
  constexpr double wide = 2 * 2;
  const Eigen::Matrix2d& cov = query.footprint.cov_uv;
  const double smallest = 0.5 * cov.trace() - std::hypot(0.5 * (cov(0, 0) - cov(1, 1)), cov(0, 1));
  if (smallest > wide) query.footprint.cov_uv = wide * Eigen::Matrix2d::Identity();
  return query;
}

}  // namespace mica::host
