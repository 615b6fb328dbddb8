// `gaussians` and `beckmanns` against `triangles`, by turns on the same queries in the same run: 65,536
// coherent footprints on a 2048^2 spectrum, roughness 0.005. Prints a table; with an argument, writes it as
// JSON to that file.

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "host/base/stopwatch.h"
#include "host/measure/coherent.h"
#include "host/measure/fma_peak.h"
#include "host/methods/beckmanns/beckmann_evaluator.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/reference/oracle.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr int kRepeats = 11;
/// A mixture, and what one of its elements takes with its share of the leaf; a multiply-add is two.
struct Mixture {
  const char* name;
  double flops_an_element;
};
constexpr Mixture kMixtures[] = {{"gaussians", 94}, {"beckmanns", 89}};

std::unique_ptr<Evaluator> make_mixture(const Mixture& mixture, Device& device, const Surface& surface,
                                        const MixtureSettings& settings) {
  if (mixture.name == std::string("gaussians"))
    return std::make_unique<GaussianEvaluator>(device, surface, settings);
  return std::make_unique<BeckmannEvaluator>(device, surface, settings);
}

/// Seconds of two evaluators, measured by turns so that a noisy neighbour disturbs both.
struct Duel {
  Timing ours, theirs;
};
Duel duel(Evaluator* ours, Evaluator* theirs, const std::vector<Query>& queries) {
  std::vector<double> our_seconds, their_seconds;
  for (int repeat = 0; repeat <= kRepeats; ++repeat) {
    for (Evaluator* evaluator : {ours, theirs}) {
      const Stopwatch watch;
      evaluator->evaluate(queries);
      const double seconds = watch.seconds();
      if (repeat > 0) (evaluator == ours ? our_seconds : their_seconds).push_back(seconds);  // 0: warm-up
    }
  }
  return {timing_of(our_seconds), timing_of(their_seconds)};
}

int run(const char* json_path) {
  Device device(0);
  SurfaceDescription description;
  description.source = SpectrumSurface{};
  const Surface surface = make_surface(description, nullptr);
  TriangleEvaluator triangles(device, surface);
  const reference::Oracle oracle(surface, 1e-7);
  const double peak = measure_fma_peak(device);
  fmt::print("device {}, multiply-add peak {:.0f} GFLOP/s\n", device.info().name, 1e-9 * peak);
  fmt::print("{:>10} {:>8} {:>6} {:>10} {:>8} {:>12} {:>21} {:>14} {:>8} {:>8} {:>12} {:>10}\n", "mixture",
             "elements", "sigma", "MiB", "build s", "queries/s", "(spread)", "elements/query", "of peak",
             "ratio", "triangles q/s", "error L2");
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& [mixture, elements] : std::vector<std::pair<Mixture, int>>{
           {kMixtures[0], 1}, {kMixtures[0], 2}, {kMixtures[1], 1}, {kMixtures[1], 2}}) {
    MixtureSettings settings;
    settings.elements = elements;
    const auto evaluator = make_mixture(mixture, device, surface, settings);
    settings.count_elements = true;
    const auto counter = make_mixture(mixture, device, surface, settings);
    for (const double sigma : {2.0, 8.0, 32.0}) {
      const std::vector<Query> queries = coherent_queries(surface, sigma);
      const std::vector<Query> batch = thinned(queries, sigma > 16 ? 16 : 1);
      const std::vector<Query> few = thinned(queries, sigma > 16 ? 1024 : sigma > 4 ? 64 : 16);
      const Duel times = duel(evaluator.get(), &triangles, batch);
      const std::vector<float> counts = counter->evaluate(batch);
      const double count = static_cast<double>(batch.size());
      const double elements_a_query = std::accumulate(counts.begin(), counts.end(), 0.0) / count;
      const double rate = count / times.ours.median_seconds,
                   triangles_rate = count / times.theirs.median_seconds;
      const double error = relative_l2(evaluator->evaluate(few), oracle.evaluate(few));
      const double share = rate * elements_a_query * mixture.flops_an_element / peak;
      fmt::print(
          "{:>10} {:>8} {:>6} {:>10.1f} {:>8.3f} {:>12.0f} {:>10.0f}-{:<10.0f} {:>14.0f} {:>7.1f}% {:>8.2f} "
          "{:>12.0f} {:>10.1e}\n",
          mixture.name, elements, sigma, static_cast<double>(evaluator->device_bytes()) / (1 << 20),
          evaluator->build_seconds(), rate, count / times.ours.highest, count / times.ours.lowest,
          elements_a_query, 100 * share, rate / triangles_rate, triangles_rate, error);
      rows.push_back({{"mixture", mixture.name},
                      {"elements", elements},
                      {"sigma_texels", sigma},
                      {"device_bytes", evaluator->device_bytes()},
                      {"build_seconds", evaluator->build_seconds()},
                      {"queries_per_second", rate},
                      {"elements_per_query", elements_a_query},
                      {"share_of_peak", share},
                      {"triangles_queries_per_second", triangles_rate},
                      {"ratio", rate / triangles_rate},
                      {"relative_l2", error}});
    }
  }
  if (json_path)
    std::ofstream(json_path) << nlohmann::ordered_json({{"device", device.info().name},
                                                        {"fma_peak_flops", peak},
                                                        {"rows", rows}})
                                    .dump(2)
                             << '\n';
  return 0;
}

}  // namespace
}  // namespace mica::host::bench

int main(int argc, char** argv) {
  try {
    return mica::host::bench::run(argc > 1 ? argv[1] : nullptr);
  } catch (const mica::Error& error) {
    fmt::print(stderr, "mixtures_bench: {}\n", error.what());
    return 1;
  }
}
