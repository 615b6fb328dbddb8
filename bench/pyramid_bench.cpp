// `pyramid` and `auto` on 2048^2 maps: error, speed, memory and build over footprints of 1 to 4096 texels,
// against the best fixed evaluator that keeps 1%, random footprints, in one run; and a zoom. Prints a table.
// Errors are relative L2 against `triangles`, which keeps 1e-4 of the oracle.
//   pyramid_bench [SURFACE... | FILE...] [--quick] [--errors | --costs]
// --errors times nothing; --costs fits the cost model of `auto`.

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <numeric>

#include "host/base/error.h"
#include "host/base/stopwatch.h"
#include "host/bench/coherent.h"
#include "host/engine/accuracy.h"
#include "host/engine/auto_evaluator.h"
#include "host/engine/cost_model.h"
#include "host/engine/make_evaluator.h"
#include "host/engine/mixture_evaluator.h"
#include "host/engine/pyramid_evaluator.h"
#include "host/engine/triangle_evaluator.h"
#include "host/surface/random.h"

namespace mica::bench {
namespace {

constexpr int kRepeats = 11;
constexpr double kSecondsARepeat = 0.03;
constexpr double kPi = 3.14159265358979323846;

Surface make_named(const std::string& name) {
  SurfaceDescription description;
  description.name = name;
  if (name == "spectrum") {
    description.source = SpectrumSurface{};
  } else if (name == "brushed") {
    description.source = BrushedSurface{};
  } else if (name == "flakes") {
    description.source = FlakesSurface{};
    description.interpolation = Interpolation::nearest;
  } else if (name == "scratches") {
    description.source = ScratchesSurface{};
  } else {
    MapFile file;
    file.path = name;
    file.invalid = TexelRepair::repair;
    description.source = file;
  }
  return make_surface(description, nullptr);
}

/// Random footprints, each with a normal under it blurred by the roughness.
std::vector<Query> random_queries(const Surface& surface, double sigma_texels, double roughness,
                                  std::size_t count) {
  std::vector<Query> queries(count);
  for (std::size_t n = 0; n < count; ++n) {
    const auto random = [&](std::uint64_t stream) { return synthesis::random_unit(7, stream, n); };
    const auto disk = [&](std::uint64_t stream) {
      const double radius = std::sqrt(-2 * std::log(1 - random(stream))),
                   angle = 2 * kPi * random(stream + 1);
      return Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
    };
    queries[n].footprint = make_footprint(surface, {random(0), random(1)}, sigma_texels, sigma_texels, 0);
    const Eigen::Vector2d place =
        Eigen::Vector2d(random(0) * surface.width(), random(1) * surface.height()) + sigma_texels * disk(2);
    const Eigen::Vector2d& normal = surface.texel(std::lround(place.x()), std::lround(place.y()));
    queries[n].half_vector = (normal + roughness * disk(4)).cwiseMax(-1).cwiseMin(1);
    queries[n].roughness = roughness;
  }
  return queries;
}

/// Queries a second: the median of the repeats after a warm-up, on as many queries as take about 0.03 s.
double rate(Evaluator* evaluator, const std::vector<Query>& queries) {
  std::size_t count = 16;
  for (; count < queries.size(); count = std::min(4 * count, queries.size())) {
    const Stopwatch watch;
    evaluator->evaluate({queries.begin(), queries.begin() + static_cast<long>(count)});
    if (watch.seconds() > kSecondsARepeat) break;
  }
  const std::vector<Query> batch(queries.begin(), queries.begin() + static_cast<long>(count));
  std::vector<double> seconds;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const Stopwatch watch;
    evaluator->evaluate(batch);
    seconds.push_back(watch.seconds());
  }
  return static_cast<double>(count) / timing_of(seconds).median_seconds;
}

double error_of(Evaluator* evaluator, const std::vector<Query>& queries, const std::vector<float>& expected) {
  const std::vector<float> densities = evaluator->evaluate(queries);
  double squares = 0, references = 0;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    squares += std::pow(densities[n] - expected[n], 2);
    references += std::pow(expected[n], 2);
  }
  return std::sqrt(squares / references);
}

struct Row {
  std::string best_fixed = "-";
  double best_rate = 0;
};

/// The fastest of the evaluators of texels that keep 1% here.
Row best_fixed(Device& device, const Surface& surface, Evaluator* triangles,
               const std::vector<Query>& queries, const std::vector<Query>& few,
               const std::vector<float>& expected) {
  Row row{"triangles", rate(triangles, queries)};
  for (const int elements : {1, 2, 4}) {
    const std::unique_ptr<Evaluator> evaluator = make_evaluator("gaussians", device, surface, elements);
    if (error_of(evaluator.get(), few, expected) > 0.01) continue;
    const double gaussians = rate(evaluator.get(), queries);
    if (gaussians > row.best_rate) row = {fmt::format("gaussians {}", elements), gaussians};
    break;  // more elements are slower
  }
  return row;
}

/// What `auto` is off by that was asked for 0.1%.
double strict_auto_error(Device& device, const Surface& surface, const std::vector<Query>& queries,
                         const std::vector<Query>& few, const std::vector<float>& expected) {
  AutoEvaluator chooser(device, surface, 0.001);
  chooser.calibrate(thinned(queries, 64));
  return error_of(&chooser, few, expected);
}

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

/// Of an evaluator, what a row of queries took and what its cost model goes by.
struct CostRow {
  double nanoseconds, blocks, counts;
};
using CostRows = std::map<std::string, std::vector<CostRow>>;

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
    if (found[static_cast<long>(lowest)] >= 0) return {found[0], found[1], found[2]};
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
  fmt::print("{:<12} {{{:.4g}, {:.3g}, {:.3g}}}, off by a factor of {:.2f} (RMS), {:.2f} at most\n",
             evaluator, model.query, model.block, model.count, std::exp(std::sqrt(squares / rows.size())),
             worst);
}

/// What queries cost and what their kernels count, of every evaluator that `auto` may choose.
void measure_costs(Device& device, const std::string& name, double roughness, CostRows* rows) {
  const Surface surface = make_named(name);
  using Count = std::function<std::vector<float>(const std::vector<Query>&)>;
  const auto measure = [&](const std::string& evaluator, const std::vector<double>& sigmas, bool blocks,
                           Evaluator* timed, const Count& counts) {
    for (const double sigma : sigmas) {
      const std::size_t count = sigma > 8 ? 1 << 10 : 1 << 12;
      const std::vector<Query> queries = random_queries(surface, sigma, roughness, count);
      CostRow row{core_nanoseconds(timed, queries), 0, mean(counts(queries))};
      if (blocks) row.blocks = blocks_reached(queries.front(), surface.width(), surface.height());
      fmt::print("{:<10} {:>5} {:>4}  {:<12} {:>10.0f} ns {:>10.0f} counts\n", name, roughness, sigma,
                 evaluator, row.nanoseconds, row.counts);
      std::fflush(stdout);
      (*rows)[evaluator].push_back(row);
    }
  };
  const std::vector<double> small = {1, 2, 4, 8, 16, 32}, large = {32, 128, 512};
  TriangleSettings triangles;
  TriangleEvaluator timed_triangles(device, surface, triangles);
  triangles.count_flops = true;
  TriangleEvaluator counting_triangles(device, surface, triangles);
  measure("triangles", small, true, &timed_triangles,
          [&](const auto& queries) { return counting_triangles.evaluate(queries); });
  for (const int elements : {1, 2, 4}) {
    MixtureSettings mixture;
    mixture.elements = elements;
    GaussianEvaluator timed(device, surface, mixture);
    mixture.count_elements = true;
    GaussianEvaluator counting(device, surface, mixture);
    measure(fmt::format("gaussians {}", elements), small, true, &timed,
            [&](const auto& queries) { return counting.evaluate(queries); });
  }
  PyramidEvaluator pyramid(device, surface);
  if (roughness >= 0.02)  // others cost alike, and their levels take long to build
    measure("pyramid", large, false, &pyramid,
            [&](const auto& queries) { return pyramid.count_elements(queries); });
}

struct Effort {
  bool quick = false;  ///< few footprints
  bool timed = true;
  bool costs = false;  ///< nothing but these
};

void measure(Device& device, const std::string& name, double roughness, const Effort& effort) {
  const Surface surface = make_named(name);
  TriangleEvaluator triangles(device, surface);
  PyramidEvaluator pyramid(device, surface);
  std::vector<double> sigmas = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096};
  if (effort.quick) sigmas = {8, 32, 128, 512};
  for (const double sigma : sigmas) {
    const std::vector<Query> queries = random_queries(surface, sigma, roughness, 1 << 16);
    const std::vector<Query> few = thinned(queries, sigma > 64 ? 1024 : sigma > 16 ? 256 : 32);
    const std::vector<float> expected = triangles.evaluate(few);
    const double pyramid_error = error_of(&pyramid, few, expected);
    AutoEvaluator chooser(device, surface, 0.01);
    chooser.calibrate(thinned(queries, 64));
    const double auto_error = error_of(&chooser, few, expected);
    const double strict_error = strict_auto_error(device, surface, queries, few, expected);
    const double pyramid_rate = effort.timed ? rate(&pyramid, queries) : 0,
                 auto_rate = effort.timed ? rate(&chooser, queries) : 0;
    const Row fixed =
        effort.timed ? best_fixed(device, surface, &triangles, queries, few, expected) : Row{"-", 1};
    fmt::print(
        "{:<10} {:>5} {:>5}  {:>8.3f}% {:>10.0f}  {:>8.3f}% {:>10.0f} {:>6.1f} MiB {:>7.2f}x  {:>8.4f}%  "
        "{:<12} {}\n",
        name, roughness, sigma, 100 * pyramid_error, pyramid_rate, 100 * auto_error, auto_rate,
        static_cast<double>(chooser.device_bytes()) / (1 << 20), auto_rate / fixed.best_rate,
        100 * strict_error, fixed.best_fixed, chooser.choices().front().evaluator);
    std::fflush(stdout);
  }
  fmt::print("{:<10} {:>5} all   built in {:.2f} s, {:.1f} MiB with the texels\n", name, roughness,
             pyramid.build_seconds(), static_cast<double>(pyramid.device_bytes()) / (1 << 20));
}

/// 300 frames from sigma 1 to 2000: the change from frame to frame, where the level changes and where it does
/// not.
void zoom(Device& device, const std::string& name, double roughness) {
  constexpr int frames = 300, half_vectors = 64;
  const Surface surface = make_named(name);
  PyramidEvaluator pyramid(device, surface);
  std::vector<Query> queries = random_queries(surface, 200, roughness, half_vectors);
  std::vector<float> last;
  std::vector<double> changes(frames, 0);
  std::vector<bool> level_changes(frames, false);
  int last_block = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const double sigma = std::pow(2000, frame / (frames - 1.0));
    for (Query& query : queries) query.footprint = make_footprint(surface, {0.37, 0.61}, sigma, sigma, 0);
    const std::vector<float> densities = pyramid.evaluate(queries);
    const auto choice = pyramid.choose(queries.front());
    const int block = choice ? choice->block + (choice->uniform ? 1 : 0) : 0;
    if (frame > 0) changes[frame] = error_of(&pyramid, queries, last);
    level_changes[frame] = frame > 0 && block != last_block;
    last_block = block, last = densities;
  }
  double worst = 0;
  for (int frame = 2; frame + 1 < frames; ++frame)
    if (level_changes[frame])
      worst = std::max(worst, changes[frame] / std::max(changes[frame - 1], changes[frame + 1]));
  const auto most = std::max_element(changes.begin(), changes.end());
  fmt::print(
      "{} roughness {}: largest change between frames {:.2f}%; at level changes up to {:.2f} times that of "
      "the "
      "frames beside it\n",
      name, roughness, 100 * *most, worst);
}

int run(std::vector<std::string> names, const Effort& effort) {
  Device device(0);
  if (names.empty()) names = {"spectrum", "brushed", "flakes", "scratches"};
  if (effort.costs) {
    CostRows rows;
    for (const std::string& name : names)
      for (const double roughness : {0.02, 0.005}) measure_costs(device, name, roughness, &rows);
    fmt::print("\nhost/engine/cost_model.cpp: ns of a query, a block, a count\n");
    for (const auto& [evaluator, measured] : rows) print_fit(evaluator, measured);
    return 0;
  }
  fmt::print("device {}; random footprints, wall clock, median of {}\n", device.info().name, kRepeats);
  fmt::print("{:<10} {:>5} {:>5}  {:>9} {:>10}  {:>9} {:>10} {:>10} {:>8}  {:>9}  {:<12} {}\n", "surface",
             "rough", "sigma", "pyramid", "queries/s", "auto 1%", "queries/s", "memory", "of best",
             "auto 0.1%", "best fixed", "auto's choice");
  for (const std::string& name : names)
    for (const double roughness : {0.02, 0.005}) measure(device, name, roughness, effort);
  for (const std::string& name : names) zoom(device, name, 0.02);
  return 0;
}

}  // namespace
}  // namespace mica::bench

int main(int argc, char** argv) {
  try {
    std::vector<std::string> names(argv + 1, argv + argc);
    const auto taken = [&names](const char* option) {
      const auto found = std::remove(names.begin(), names.end(), option);
      const bool given = found != names.end();
      names.erase(found, names.end());
      return given;
    };
    mica::bench::Effort effort;
    effort.quick = taken("--quick");
    effort.timed = !taken("--errors");
    effort.costs = taken("--costs");
    return mica::bench::run(names, effort);
  } catch (const mica::Error& error) {
    fmt::print(stderr, "pyramid_bench: {}\n", error.what());
    return static_cast<int>(error.code());
  }
}
