#include "host/measure/suite.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <functional>

#include "host/base/stopwatch.h"
#include "host/measure/bandwidth.h"
#include "host/measure/coherent.h"
#include "host/measure/fma_peak.h"
#include "host/measure/grid_points.h"
#include "host/measure/pictures.h"
#include "host/measure/thumbnails.h"
#include "host/reference/oracle.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr double kOracleTolerance = 1e-7;  // a thousandth of what the best evaluator promises

struct NamedSurface {
  std::string name;
  std::function<SurfaceDescription(int resolution)> describe;
};

template <typename Kind>
SurfaceDescription described(Kind kind, int resolution,
                             Interpolation interpolation = Interpolation::bilinear) {
  kind.resolution = resolution;
  return {"bench", kind, interpolation};
}

const NamedSurface kSpectrum{"spectrum", [](int n) { return described(SpectrumSurface{}, n); }};
const NamedSurface kBrushed{"brushed", [](int n) { return described(BrushedSurface{}, n); }};
const NamedSurface kFlakes{"flakes",
                           [](int n) { return described(FlakesSurface{}, n, Interpolation::nearest); }};
const NamedSurface kScratches{"scratches", [](int n) { return described(ScratchesSurface{}, n); }};

struct Suite {
  std::vector<NamedSurface> surfaces;
  int resolution;
  std::vector<int> map_sizes;
  std::vector<double> sigmas_texels, roughnesses;
  std::vector<int> elements;
  Effort effort;
  double reference_share;  ///< share of 1024 queries at a small footprint; fewer at large ones
  int thumbnail_side, picture_width;
};

Suite find_suite(const std::string& name) {
  if (name == "tiny")
    return {{kSpectrum, kFlakes}, 128, {64, 128}, {2, 8}, {0.02}, {1}, {3, 0.002}, 0.05, 16, 16};
  if (name == "quick")
    return {
        {kSpectrum, kFlakes}, 1024, {512, 1024, 2048}, {2, 8, 32}, {0.005}, {1, 2}, {10, 0.01}, 0.25, 48, 72};
  if (name == "standard")
    return {{kSpectrum, kBrushed, kFlakes, kScratches},
            2048,
            {256, 512, 1024, 2048, 4096},
            {2, 8, 32, 128},
            {0.005, 0.02},
            {1, 2, 4},
            {11, 0.04},
            1,
            64,
            128};
  throw UsageError(fmt::format("there is no suite \"{}\"; expected tiny, quick or standard", name));
}

/// The oracle's cost grows with the footprint's area.
std::vector<Query> few_of(const std::vector<Query>& queries, double sigma_texels, double share) {
  const double count = share * (sigma_texels > 64   ? 24
                                : sigma_texels > 16 ? 128
                                : sigma_texels > 4  ? 512
                                                    : 1024);
  // An odd stride visits every column of the block.
  return thinned(queries, static_cast<std::size_t>(static_cast<double>(queries.size()) / count) | 1);
}

/// A surface with everything that answers on it.
struct Bench {
  std::string name;
  Surface surface;
  reference::Oracle oracle;
  std::vector<Prepared> contenders;

  Bench(const NamedSurface& named, int resolution, const std::vector<Contender>& all, Device& device)
      : name(named.name),
        surface(make_surface(named.describe(resolution), nullptr)),
        oracle(surface, kOracleTolerance),
        contenders(prepare(all, device, surface)) {}
};

Cell measure_cell(const Suite& suite, const Bench& bench, double reference_share, double sigma_texels,
                  double roughness, const Machine& machine, const Progress& progress) {
  Question question{
      bench.surface, sigma_texels, coherent_queries(bench.surface, sigma_texels, roughness), {}, {}};
  question.few = few_of(question.queries, sigma_texels, reference_share);
  const std::string place = fmt::format("{} of {} texels, footprint {}, roughness {}", bench.name,
                                        bench.surface.width(), sigma_texels, roughness);
  progress(place + ": reference");
  for (const reference::OracleResult& result : bench.oracle.evaluate(question.few))
    question.references.push_back(result.density);
  Cell cell{bench.name, bench.surface.width(), sigma_texels, roughness, question.few.size(), {}};
  cell.measurements =
      measure_by_turns(bench.contenders, question, machine, suite.effort,
                       [&](const Prepared& prepared) { progress(place + ": " + prepared.contender.label); });
  return cell;
}

void measure_cells(const Suite& suite, const Machine& machine, const MethodRegistry& methods, Device& device,
                   const Progress& progress, Results* results) {
  for (const NamedSurface& named : suite.surfaces) {
    progress(fmt::format("building {} of {} texels", named.name, suite.resolution));
    const Bench bench(named, suite.resolution, contenders(methods, suite.elements), device);
    for (const double sigma_texels : suite.sigmas_texels)
      for (const double roughness : suite.roughnesses)
        results->cells.push_back(
            measure_cell(suite, bench, suite.reference_share, sigma_texels, roughness, machine, progress));
    results->thumbnails.push_back(
        thumbnails(named.name, bench.surface, bench.contenders, suite.thumbnail_side, progress));
  }
}

void measure_map_sizes(const Suite& suite, const Machine& machine, const MethodRegistry& methods,
                       Device& device, const Progress& progress, Results* results) {
  constexpr double sigma_texels = 8, roughness = 0.005;
  for (const int size : suite.map_sizes) {
    progress(fmt::format("building spectrum of {} texels", size));
    const Bench bench(kSpectrum, size, without_curves(contenders(methods, {1})), device);
    results->map_sizes.push_back(
        measure_cell(suite, bench, suite.reference_share / 8, sigma_texels, roughness, machine, progress));
  }
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace

const std::vector<std::string>& suite_names() {
  static const std::vector<std::string> names = {"tiny", "quick", "standard"};
  return names;
}

Results run_suite(const std::string& name, Device& device, const Progress& progress,
                  const MethodRegistry& methods) {
  const Stopwatch watch;
  const Suite suite = find_suite(name);
  Results results;
  results.suite = name;
  results.started = utc_now();
  results.device = device.info();
  progress("multiply-add peak and memory bandwidth");
  results.fma_peak = measure_fma_peak(device);
  results.bandwidth = measure_bandwidth(device);
  const Machine machine{results.fma_peak, results.bandwidth};
  measure_cells(suite, machine, methods, device, progress, &results);
  measure_map_sizes(suite, machine, methods, device, progress, &results);
  results.grid = measure_grid(device, suite.effort, progress);
  render_pictures(suite.picture_width, without_curves(contenders(methods, suite.elements)), device, progress,
                  &results);
  results.seconds = watch.seconds();
  return results;
}

}  // namespace mica::host::bench
