#pragma once

#include "host/methods/grid/grid_query.h"
#include "host/methods/standard.h"
#include "host/reference/glint_grid.h"

namespace mica::host {

/// `grid` is held to [Kem25] Algorithm 1, its definition.
class GridStandard : public Standard {
 public:
  explicit GridStandard(const GlintGrid& grid);

  std::vector<double> references(const std::vector<Query>& queries) const override;
  Promise promise(double) const override { return {1e-4, 1e-6}; }
  double error(const Query& query, double density, double reference, double peak) const override;
  std::string limitation(const std::vector<std::vector<Query>>& probes, const Query& worst,
                         double worst_error) const override;

 private:
  int level_of(const Query& query) const;

  double density_;
  reference::GlintProcess process_;
};

}  // namespace mica::host
