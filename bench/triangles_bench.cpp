// `triangles` against the paper's own recursion, on the same queries in the same run: 65,536 coherent
// footprints on a 2048^2 spectrum, roughness 0.005. Prints a table; with an argument, writes it as JSON to
// that file.

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "bench/paper_recursion.h"
#include "host/base/stopwatch.h"
#include "host/measure/coherent.h"
#include "host/measure/fma_peak.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/reference/oracle.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr int kRepeats = 11;

template <typename Work>
Timing time_repeats(Work work) {
  work();  // warm-up
  std::vector<double> seconds;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const Stopwatch watch;
    work();
    seconds.push_back(watch.seconds());
  }
  return timing_of(seconds);
}

int run(const char* json_path) {
  Device device(0);
  SurfaceDescription description;
  description.source = SpectrumSurface{};
  SurfaceReport report;
  const Surface surface = make_surface(description, &report);
  TriangleEvaluator triangles(device, surface);
  TriangleSettings counting;
  counting.count_flops = true;
  TriangleEvaluator counter(device, surface, counting);
  const PaperRecursion recursion(surface);
  const reference::Oracle oracle(surface, 1e-7);
  const double peak = measure_fma_peak(device);

  fmt::print("device {}, {} compute units, multiply-add peak {:.0f} GFLOP/s\n", device.info().name,
             device.info().compute_units, 1e-9 * peak);
  fmt::print("structures {:.1f} MiB, built in {:.3f} s\n",
             static_cast<double>(triangles.device_bytes()) / (1 << 20), triangles.build_seconds());
  fmt::print("{:>6} {:>14} {:>17} {:>12} {:>8} {:>16} {:>8} {:>10} {:>10}\n", "sigma", "queries/s",
             "(spread)", "flop/query", "of peak", "recursion q/s", "ratio", "error L2", "paper's L2");
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const double sigma : {2.0, 8.0, 32.0}) {
    const std::vector<Query> queries = coherent_queries(surface, sigma);
    const std::vector<Query> batch = thinned(queries, sigma > 16 ? 16 : 1);
    const std::vector<Query> few = thinned(queries, sigma > 16 ? 1024 : sigma > 4 ? 64 : 16);
    const Timing ours = time_repeats([&] { triangles.evaluate(batch); });
    const Timing paper = time_repeats([&] { recursion.evaluate(few); });
    const std::vector<float> flops = counter.evaluate(batch);
    const double flops_a_query =
        std::accumulate(flops.begin(), flops.end(), 0.0) / static_cast<double>(flops.size());
    const double rate = static_cast<double>(batch.size()) / ours.median_seconds;
    const double paper_rate = static_cast<double>(few.size()) / paper.median_seconds;
    const auto references = oracle.evaluate(few);
    const double error = relative_l2(triangles.evaluate(few), references);
    const double paper_error = relative_l2(recursion.evaluate(few), references);
    fmt::print(
        "{:>6} {:>14.0f} {:>8.0f}-{:<8.0f} {:>12.0f} {:>7.1f}% {:>16.0f} {:>8.1f} {:>10.1e} {:>10.1e}\n",
        sigma, rate, static_cast<double>(batch.size()) / ours.highest,
        static_cast<double>(batch.size()) / ours.lowest, flops_a_query, 100 * rate * flops_a_query / peak,
        paper_rate, rate / paper_rate, error, paper_error);
    rows.push_back({{"sigma_texels", sigma},
                    {"queries", batch.size()},
                    {"queries_per_second", rate},
                    {"flops_per_query", flops_a_query},
                    {"share_of_peak", rate * flops_a_query / peak},
                    {"recursion_queries_per_second", paper_rate},
                    {"ratio", rate / paper_rate},
                    {"relative_l2", error},
                    {"recursion_relative_l2", paper_error}});
  }
  if (json_path) {
    std::ofstream(json_path) << nlohmann::ordered_json({{"device", device.info().name},
                                                        {"fma_peak_flops", peak},
                                                        {"build_seconds", triangles.build_seconds()},
                                                        {"device_bytes", triangles.device_bytes()},
                                                        {"rows", rows}})
                                    .dump(2)
                             << '\n';
  }
  return 0;
}

}  // namespace
}  // namespace mica::host::bench

int main(int argc, char** argv) {
  try {
    return mica::host::bench::run(argc > 1 ? argv[1] : nullptr);
  } catch (const mica::Error& error) {
    fmt::print(stderr, "triangles_bench: {}\n", error.what());
    return 1;
  }
}
