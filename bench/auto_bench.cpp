// Fits the cost model of `auto`: what queries of random footprints cost each evaluator, in nanoseconds of a
// core, against what is counted of them: as they are, and turning by a lobe over their footprint. Prints the
// rows and, for host/methods/auto/cost_model.cpp, the fits.
//   auto_bench [SURFACE... | FILE...]

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <numeric>

#include "bench/bench_maps.h"
#include "host/measure/coherent.h"
#include "host/methods/auto/cost_model.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/pyramid/pyramid_evaluator.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr int kRepeats = 11;
constexpr double kTolerance = 0.01;  // of triangles

/// Nanoseconds of one core that a query takes.
double core_nanoseconds(Evaluator* evaluator, const std::vector<Query>& queries) {
  evaluator->evaluate(thinned(queries, 64));
  std::vector<double> seconds;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const std::clock_t start = std::clock();
    evaluator->evaluate(queries);
    seconds.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return 1e9 * timing_of(seconds).median_seconds / static_cast<double>(queries.size());
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The same queries, whose half vectors turn by a lobe over their footprints, each along its own axis.
std::vector<Query> turning(std::vector<Query> queries) {
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const double lobes_a_footprint =
        queries[n].roughness / std::sqrt(queries[n].footprint.cov_uv.trace() / 2);
    queries[n].half_vector_turn =
        lobes_a_footprint * Eigen::Rotation2Dd(static_cast<double>(n)).toRotationMatrix();
  }
  return queries;
}

/// What a row of queries took an evaluator, and what its cost model goes by.
struct CostRow {
  double nanoseconds, blocks, counts;
};
using CostRows = std::map<std::string, std::vector<CostRow>>;
using Count = std::function<std::vector<float>(const std::vector<Query>&)>;

struct BenchMap {
  std::string name;
  Surface surface;
  double roughness;
};

/// The model with the least squares of relative differences; what would be negative is left out.
CostModel fit(const std::vector<CostRow>& rows) {
  std::array<bool, 3> used = {true, true, true};
  for (;;) {
    Eigen::MatrixXd terms(rows.size(), 3);
    for (std::size_t n = 0; n < rows.size(); ++n)
      terms.row(static_cast<long>(n)) << used[0], used[1] * rows[n].blocks, used[2] * rows[n].counts;
    for (std::size_t n = 0; n < rows.size(); ++n) terms.row(static_cast<long>(n)) /= rows[n].nanoseconds;
    const Eigen::VectorXd found =
        terms.completeOrthogonalDecomposition().solve(Eigen::VectorXd::Ones(terms.rows()));
    const auto lowest =
        static_cast<std::size_t>(std::min_element(found.data(), found.data() + 3) - found.data());
    if (found[static_cast<long>(lowest)] >= 0) return {found[0], found[1], found[2], 0};
    used[lowest] = false;
  }
}

void print_fit(const std::string& evaluator, const std::vector<CostRow>& rows) {
  const CostModel model = fit(rows);
  double worst = 1, squares = 0;
  for (const CostRow& row : rows) {
    const double ratio = std::log(model.of(row.blocks, row.counts) / row.nanoseconds);
    worst = std::max(worst, std::exp(std::abs(ratio)));
    squares += ratio * ratio;
  }
  fmt::print("{:<34} {{{:.4g}, {:.3g}, {:.3g}}}, off by a factor of {:.2f} (RMS), {:.2f} at most\n",
             evaluator, model.query, model.block, model.count, std::exp(std::sqrt(squares / rows.size())),
             worst);
}

/// Adds what queries of the footprints cost and what is counted of them, to the rows of a name and, of those
/// that turn, to its others.
void measure(const BenchMap& map, const std::vector<double>& sigmas, Evaluator* timed, const Count& counts,
             const std::string& name, CostRows* rows) {
  for (const double sigma : sigmas) {
    const std::size_t count = sigma > 8 ? 1 << 10 : 1 << 12;
    const std::vector<Query> still = random_queries(map.surface, sigma, map.roughness, count);
    for (const bool turns : {false, true}) {
      const std::vector<Query> queries = turns ? turning(still) : still;
      CostRow row{core_nanoseconds(timed, queries), 0, mean(counts(queries))};
      if (timed->name() != "pyramid")
        row.blocks = blocks_reached(queries.front(), map.surface.width(), map.surface.height());
      const std::string of = name + (turns ? ", first order" : "");
      fmt::print("{:<10} {:>5} {:>4}  {:<34} {:>10.0f} ns {:>10.0f} counts\n", map.name, map.roughness, sigma,
                 of, row.nanoseconds, row.counts);
      std::fflush(stdout);
      (*rows)[of].push_back(row);
    }
  }
}

/// Rows of every evaluator that `auto` may choose.
void measure_all(Device& device, const BenchMap& map, CostRows* rows) {
  const std::vector<double> small = {1, 2, 4, 8, 16, 32}, large = {32, 128, 512};
  {
    TriangleSettings settings;
    settings.tolerance = kTolerance;
    TriangleEvaluator timed(device, map.surface, settings);
    settings.count_flops = true;
    TriangleEvaluator counting(device, map.surface, settings);
    const bool nearest = map.surface.interpolation() == Interpolation::nearest;
    measure(
        map, small, &timed, [&](const auto& queries) { return counting.evaluate(queries); },
        nearest ? "triangles, nearest" : "triangles, bilinear", rows);
  }
  MixtureSettings counted;
  counted.elements = kCountedMixture;
  counted.count_elements = true;
  GaussianEvaluator counting(device, map.surface, counted);
  for (const int elements : {1, 2, 4}) {
    MixtureSettings settings;
    settings.elements = elements;
    GaussianEvaluator timed(device, map.surface, settings);
    measure(
        map, small, &timed, [&](const auto& queries) { return counting.evaluate(queries); },
        fmt::format("gaussians, {}", elements), rows);
  }
  PyramidEvaluator pyramid(device, map.surface);
  if (map.roughness >= 0.02)  // others cost alike, and their levels take long to build
    measure(
        map, large, &pyramid, [&](const auto& queries) { return pyramid.count_elements(queries); }, "pyramid",
        rows);
}

void fit_costs(Device& device, const std::vector<std::string>& names) {
  CostRows rows;
  for (const std::string& name : names)
    for (const double roughness : {0.02, 0.005})
      measure_all(device, {name, make_named(name), roughness}, &rows);
  fmt::print("\nhost/methods/auto/cost_model.cpp: ns of a query, a block, a count\n");
  for (const auto& [evaluator, measured] : rows) print_fit(evaluator, measured);
}

}  // namespace
}  // namespace mica::host::bench

int main(int argc, char** argv) {
  try {
    std::vector<std::string> names(argv + 1, argv + argc);
    if (names.empty()) names = {"spectrum", "brushed", "flakes", "scratches"};
    mica::host::Device device(0);
    mica::host::bench::fit_costs(device, names);
    return 0;
  } catch (const mica::Error& error) {
    fmt::print(stderr, "auto_bench: {}\n", error.what());
    return 1;
  }
}
