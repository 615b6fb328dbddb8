#include "host/methods/grid/grid_standard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/methods/map/turned_query.h"

namespace mica::host {

GridStandard::GridStandard(const GlintGrid& grid) : density_(grid.density) {
  process_.beckmann = grid.distribution == Distribution::beckmann;
  process_.alpha_x = grid.alpha_x, process_.alpha_y = grid.alpha_y;
  process_.density = grid.density, process_.stretch = grid.stretch, process_.seed = grid.seed;
}

std::vector<double> GridStandard::references(const std::vector<Query>& queries) const {
  std::vector<double> densities;
  for (const Query& query : queries) densities.push_back(process_.density_of(query));
  return densities;
}

/// Allowed is 1e-4 of the reference and 1e-6 of the smooth distribution. Where the footprint is a power of
/// two of cells, the definition steps to the next level and widens the footprint by another part of a cell:
/// rounding decides, so both sides are right.
double GridStandard::error(const Query& query, double density, double, double) const {
  constexpr double rounding = 1e-12;
  const double smooth = process_.smooth_density(query.half_vector);
  double least = std::numeric_limits<double>::infinity();
  for (const double factor : {1.0, 1 - rounding, 1 + rounding}) {
    Query side = query;
    side.footprint.cov_uv *= factor;
    const double reference = process_.density_of(side), difference = std::abs(density - reference);
    least = std::min(least, difference == 0 ? 0 : difference / (1e-4 * reference + 1e-6 * smooth));
  }
  return least;
}

/// Where a float's half vector, 6e-8 apart from the next, is the limit. docs/accuracy.md, grid.
std::string GridStandard::limitation(const std::vector<std::vector<Query>>&, const Query& worst,
                                     double worst_error) const {
  constexpr double beside_the_rim = 1e-6, narrow_lobe = 5e-3;
  constexpr int narrow_cell = 12;
  if (worst.half_vector.norm() > 1 - beside_the_rim)
    return fmt::format("half vectors within 1e-6 of the rim are rounded to floats: {:.3g} times the bound",
                       worst_error);
  if (level_of(worst) >= narrow_cell)
    return fmt::format("angular cells are narrower than 2^-12: {:.3g} times the bound", worst_error);
  if (lobe_axes(worst).sigma.minCoeff() < narrow_lobe)
    return fmt::format("lobes of glints are narrower than 5e-3: {:.3g} times the bound", worst_error);
  return "";
}

/// The coarser of the two levels that answer.
int GridStandard::level_of(const Query& query) const {
  const Eigen::Matrix2d& c = query.footprint.cov_uv;
  const double major2 = 0.5 * c.trace() + std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1));
  return static_cast<int>(std::max(0.5 * std::log2(64 * std::max(major2 * density_, 1e-100)), 0.0)) + 1;
}

}  // namespace mica::host
