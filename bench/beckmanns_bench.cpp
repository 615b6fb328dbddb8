// What masking adds to the BRDF of `beckmanns`: `geometric`, which is D and nothing else on the device,
// `filtered` and `exact` by turns on the same queries in the same run. 65,536 coherent footprints on a 2048^2
// spectrum, roughness 0.005, half vectors as in mixtures_bench, views at three angles to the geometric
// normal. Prints a table; with an argument, writes it as JSON to that file.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/masking.h"
#include "host/base/stopwatch.h"
#include "host/device/device.h"
#include "host/measure/coherent.h"
#include "host/methods/patch_brdf.h"
#include "host/methods/registry.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr int kRepeats = 11;
constexpr int kMaskings = 3;

/// Queries with the half vectors of `coherent_queries`, seen from `degrees`.
std::vector<BrdfQuery> brdf_queries(const Surface& surface, double sigma_texels, double degrees) {
  std::vector<BrdfQuery> queries;
  const double polar = degrees * M_PI / 180;
  const Eigen::Vector3d view(std::sin(polar), 0, std::cos(polar));
  for (const Query& query : thinned(coherent_queries(surface, sigma_texels), sigma_texels > 16 ? 16 : 1)) {
    const Eigen::Vector2d& h = query.half_vector;
    const Eigen::Vector3d half(h.x(), h.y(), std::sqrt(1 - h.squaredNorm()));
    queries.push_back({query.footprint, view, 2 * view.dot(half) * half - view, query.roughness});
  }
  return queries;
}

int run(const char* json_path) {
  Device device(0);
  SurfaceDescription description;
  description.source = SpectrumSurface{};
  const Surface surface = make_surface(description, nullptr);
  std::array<std::unique_ptr<PatchBrdf>, kMaskings> brdfs;
  const std::array<Masking, kMaskings> maskings = {Masking::geometric, Masking::filtered, Masking::exact};
  for (int n = 0; n < kMaskings; ++n) {
    brdfs[n] =
        make_patch_brdf("beckmanns", device, surface, {{"masking", std::string(word_of(maskings[n]))}});
  }
  fmt::print("device {}\n{:>6} {:>8} {:>16} {:>16} {:>16} {:>10} {:>10} {:>10}\n", device.info().name,
             "sigma", "degrees", "geometric q/s", "filtered q/s", "exact q/s", "filtered", "exact", "MiB");
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const double sigma : {2.0, 8.0, 32.0}) {
    for (const double degrees : {0.0, 45.0, 75.0}) {
      const std::vector<BrdfQuery> queries = brdf_queries(surface, sigma, degrees);
      std::array<std::vector<double>, kMaskings> seconds;
      for (int repeat = 0; repeat <= kRepeats; ++repeat) {
        for (int n = 0; n < kMaskings; ++n) {
          const Stopwatch watch;
          brdfs[n]->evaluate(queries);
          if (repeat > 0) seconds[n].push_back(watch.seconds());  // 0: warm-up
        }
      }
      std::array<double, kMaskings> rates{};
      for (int n = 0; n < kMaskings; ++n)
        rates[n] = static_cast<double>(queries.size()) / timing_of(seconds[n]).median_seconds;
      const double mebibytes = static_cast<double>(brdfs[2]->device_bytes()) / (1 << 20);
      fmt::print("{:>6} {:>8} {:>16.0f} {:>16.0f} {:>16.0f} {:>+9.0f}% {:>+9.0f}% {:>10.1f}\n", sigma,
                 degrees, rates[0], rates[1], rates[2], 100 * (rates[0] / rates[1] - 1),
                 100 * (rates[0] / rates[2] - 1), mebibytes);
      rows.push_back({{"sigma_texels", sigma},
                      {"view_degrees", degrees},
                      {"geometric_queries_per_second", rates[0]},
                      {"filtered_queries_per_second", rates[1]},
                      {"exact_queries_per_second", rates[2]},
                      {"device_bytes", brdfs[2]->device_bytes()}});
    }
  }
  if (json_path)
    std::ofstream(json_path)
        << nlohmann::ordered_json({{"device", device.info().name}, {"rows", rows}}).dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace mica::host::bench

int main(int argc, char** argv) {
  try {
    return mica::host::bench::run(argc > 1 ? argv[1] : nullptr);
  } catch (const mica::Error& error) {
    fmt::print(stderr, "masking_bench: {}\n", error.what());
    return 1;
  }
}
