#include "host/verify/grid_checks.h"

#include "host/base/constants.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/interrupt.h"
#include "host/base/random.h"
#include "host/methods/grid/grid_brdf.h"
#include "host/reference/glint_draws.h"

namespace mica::host {
namespace {

constexpr double kRelativeBound = 1e-4, kSmoothBound = 1e-6;
constexpr double kDrawBound = 5e-4;

GlintsDescription glints_of(Distribution distribution, double alpha, double density) {
  GlintsDescription glints;
  glints.distribution = distribution;
  glints.alpha = {alpha, 0.7 * alpha};
  glints.density = density;
  glints.stretch = 2;
  return glints;
}

/// Footprints from a hundredth of a cell to a hundred, half vectors all over the distribution.
std::vector<Query> queries_for(const GlintsDescription& glints, const reference::GlintProcess& process) {
  constexpr std::size_t count = 500;
  std::uint64_t counter = 0;
  const auto random = [&] { return random_unit(1, 0, counter++); };
  std::vector<Query> queries(count);
  for (Query& query : queries) {
    query.footprint.mean_uv = {random(), random()};
    query.footprint.cov_uv *= std::pow(0.01 * std::pow(1e4, random()), 2) / glints.density;
    const double radius = 0.49 * std::sqrt(random()), turn = 2 * kPi * random();
    query.half_vector = process.from_disk({0.5 + radius * std::cos(turn), 0.5 + radius * std::sin(turn)});
    query.roughness = 5e-3 * std::pow(20, random());
  }
  return queries;
}

/// The same with half vectors that turn by a tenth of a lobe to four over the footprint, and lobes to 2:1.
std::vector<Query> turned_queries_for(const GlintsDescription& glints,
                                      const reference::GlintProcess& process) {
  std::vector<Query> queries = queries_for(glints, process);
  for (std::size_t n = 0; n < queries.size(); ++n) {
    Query& query = queries[n];
    const double lobe = query.roughness, slant = 2 * kPi * random_unit(2, 0, n);
    Eigen::Matrix2d along;
    along << std::cos(slant), -std::sin(slant), 0.5 * std::sin(slant), 0.5 * std::cos(slant);
    query.half_vector_turn =
        0.1 * std::pow(40, random_unit(2, 1, n)) * lobe / std::sqrt(query.footprint.cov_uv(0, 0)) * along;
    query.lobe_cov = lobe * lobe * (Eigen::Matrix2d() << 3, 1.5, 1.5, 2).finished();
  }
  return queries;
}

/// The largest error in units of what is allowed; what is no number counts as infinite.
void take(double error, double allowed, Check* check) {
  ++check->points;
  const double ratio = error / allowed;
  if (!(ratio <= check->worst)) check->worst = std::isnan(ratio) ? HUGE_VAL : ratio;
}

void check_densities(Device* device, const GlintsDescription& glints, const std::vector<Query>& queries,
                     Check* check) {
  const GlintGrid grid = grid_of(glints);
  const reference::GlintProcess process(grid.point());
  const std::vector<float> densities = GridEvaluator(*device, grid).evaluate(queries);
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const double expected = process.density_of(queries[n]),
                 smooth = process.smooth_density(queries[n].half_vector);
    take(std::abs(densities[n] - expected), kRelativeBound * expected + kSmoothBound * smooth, check);
  }
}

/// Seen from straight above, where half vectors up to 45 degrees have a light above the horizon.
void check_draws(Device* device, const GlintsDescription& glints, Check* check) {
  const reference::GlintProcess process(grid_of(glints).point());
  std::vector<BrdfQuery> lit;
  std::vector<double> expected;
  for (const Query& query : queries_for(glints, process)) {
    const double cosine = std::sqrt(1 - query.half_vector.squaredNorm());
    if (cosine < 0.75) continue;
    const Eigen::Vector3d half(query.half_vector.x(), query.half_vector.y(), cosine);
    lit.push_back({query.footprint, Eigen::Vector3d::UnitZ(),
                   (2 * cosine * half - Eigen::Vector3d::UnitZ()).normalized(), query.roughness});
    expected.push_back(reference::glint_draw_density(process, query) /
                       4);  // the density of h, then that of i: o.h = g.h
  }
  const std::vector<BrdfValue> values = GridBrdf(*device, glints).evaluate(lit);
  for (std::size_t n = 0; n < values.size(); ++n)
    take(std::abs(values[n].pdf - expected[n]), kDrawBound * expected[n], check);
}

}  // namespace

std::vector<Check> check_grid(Device* device) {
  std::vector<Check> checks;
  for (const Distribution distribution : {Distribution::trowbridge_reitz, Distribution::beckmann}) {
    const std::string name = distribution == Distribution::beckmann ? "beckmann" : "ggx";
    Check densities{"grid: " + name}, turns{"grid: turns of " + name}, draws{"grid: draws of " + name};
    for (const double alpha : {0.1, 0.4, 0.8}) {
      check_interrupt();
      const GlintsDescription glints = glints_of(distribution, alpha, 1e6);
      const reference::GlintProcess process(grid_of(glints).point());
      check_densities(device, glints, queries_for(glints, process), &densities);
      check_densities(device, glints, turned_queries_for(glints, process), &turns);
      check_draws(device, glints, &draws);
    }
    checks.push_back(densities), checks.push_back(turns), checks.push_back(draws);
  }
  return checks;
}

}  // namespace mica::host
