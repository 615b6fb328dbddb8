#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "host/methods/standard.h"
#include "host/reference/oracle.h"

namespace mica::host {

/// The map's own density, in double precision, to what a method promises at a roughness.
class OracleStandard : public Standard {
 public:
  /// @param oracle has to outlive it.
  OracleStandard(const reference::Oracle& oracle, std::function<Promise(double roughness)> promise)
      : oracle_(oracle), promise_(std::move(promise)) {}

  std::vector<double> references(const std::vector<Query>& queries) const override {
    std::vector<double> densities;
    for (const reference::OracleResult& result : oracle_.evaluate(queries))
      densities.push_back(result.density);
    return densities;
  }
  Promise promise(double roughness) const override { return promise_(roughness); }
  bool is_the_map() const override { return true; }
  double highest(const Query& query) const override {
    const Promise allowed = promise_(query.roughness);
    return (1 + 2e-3 + allowed.relative + allowed.of_peak) * lobe_peak(query);
  }

 private:
  const reference::Oracle& oracle_;
  std::function<Promise(double)> promise_;
};

}  // namespace mica::host
