// `cavities` against `beckmanns` with filtered masking [Che18], by turns on the same queries in the same run:
// 65,536 coherent footprints on a 2048^2 spectrum, roughness 0.005, whole BRDFs. Prints a table; with an
// argument, writes it as JSON to that file.

#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "host/base/stopwatch.h"
#include "host/measure/coherent.h"
#include "host/methods/cavities/cavity_brdf.h"
#include "host/methods/registry.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr int kRepeats = 11;

/// The half vectors of a highlight's edge, as the lights that mirror one view in them.
std::vector<BrdfQuery> with_lights(const std::vector<Query>& queries) {
  const Eigen::Vector3d view = Eigen::Vector3d(0.5, 0.2, 0.84).normalized();
  std::vector<BrdfQuery> result;
  for (const Query& query : queries) {
    const Eigen::Vector2d& s = query.half_vector;
    const Eigen::Vector3d half(s.x(), s.y(), std::sqrt(std::max(1 - s.squaredNorm(), 0.0)));
    result.push_back({query.footprint, view, 2 * half.dot(view) * half - view, query.roughness});
  }
  return result;
}

struct Contender {
  std::string name;
  std::unique_ptr<PatchBrdf> brdf;
};

std::vector<Contender> make_contenders(Device& device, const Surface& surface) {
  std::vector<Contender> contenders;
  contenders.push_back(
      {"beckmanns, filtered", make_patch_brdf("beckmanns", device, surface, {{"masking", "filtered"}})});
  for (const LostEnergy energy : {LostEnergy::sampled, LostEnergy::exact}) {
    for (const int per_texel : {1, 2}) {
      CavitySettings settings;
      settings.energy = energy, settings.per_texel = per_texel;
      contenders.push_back(
          {fmt::format("cavities, {}, spacing {}", word_of(energy), per_texel == 1 ? "1" : "0.5"),
           std::make_unique<CavityBrdf>(device, surface, settings)});
    }
  }
  return contenders;
}

/// Seconds of all contenders, measured by turns so that a noisy neighbour disturbs each.
std::vector<Timing> tournament(const std::vector<Contender>& contenders,
                               const std::vector<BrdfQuery>& queries) {
  std::vector<std::vector<double>> seconds(contenders.size());
  for (int repeat = 0; repeat <= kRepeats; ++repeat) {
    for (std::size_t n = 0; n < contenders.size(); ++n) {
      const Stopwatch watch;
      contenders[n].brdf->evaluate(queries);
      if (repeat > 0) seconds[n].push_back(watch.seconds());  // 0: warm-up
    }
  }
  std::vector<Timing> timings;
  for (const std::vector<double>& of_one : seconds) timings.push_back(timing_of(of_one));
  return timings;
}

int run(const char* json_path) {
  Device device(0);
  SurfaceDescription description;
  description.source = SpectrumSurface{};
  const Surface surface = make_surface(description, nullptr);
  const std::vector<Contender> contenders = make_contenders(device, surface);
  fmt::print("device {}\n{:>6}  {:<28} {:>8} {:>8} {:>12} {:>21} {:>8}\n", device.info().name, "sigma",
             "BRDF", "MiB", "build s", "queries/s", "(spread)", "cost");
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const double sigma : {0.7, 2.0, 8.0, 32.0}) {
    const std::vector<BrdfQuery> queries =
        with_lights(thinned(coherent_queries(surface, sigma), sigma > 16  ? 16
                                                              : sigma > 4 ? 4
                                                                          : 1));
    const std::vector<Timing> timings = tournament(contenders, queries);
    const auto count = static_cast<double>(queries.size());
    for (std::size_t n = 0; n < contenders.size(); ++n) {
      const PatchBrdf& brdf = *contenders[n].brdf;
      const double cost = timings[n].median_seconds / timings[0].median_seconds;
      fmt::print("{:>6}  {:<28} {:>8.1f} {:>8.3f} {:>12.0f} {:>10.0f}-{:<10.0f} {:>8.2f}\n", sigma,
                 contenders[n].name, static_cast<double>(brdf.device_bytes()) / (1 << 20),
                 brdf.build_seconds(), count / timings[n].median_seconds, count / timings[n].highest,
                 count / timings[n].lowest, cost);
      rows.push_back({{"sigma_texels", sigma},
                      {"brdf", contenders[n].name},
                      {"device_bytes", brdf.device_bytes()},
                      {"build_seconds", brdf.build_seconds()},
                      {"queries_per_second", count / timings[n].median_seconds},
                      {"cost_of_beckmanns", cost}});
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
    fmt::print(stderr, "cavities_bench: {}\n", error.what());
    return 1;
  }
}
