// `pyramid` prototype bench
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <numeric>

#include "host/base/error.h"
#include "host/base/stopwatch.h"
#include "host/bench/coherent.h"
#include "host/engine/accuracy.h"
#include "host/engine/pyramid_evaluator.h"
#include "host/engine/triangle_evaluator.h"
#include "host/reference/oracle.h"
#include "host/surface/random.h"

namespace mica::bench {
namespace {

Surface make(const std::string& kind) {
  SurfaceDescription description;
  if (kind == "spectrum") description.source = SpectrumSurface{};
  if (kind == "small") description.source = SpectrumSurface{256, 0.15, 8, 3};
  if (kind == "brushed") description.source = BrushedSurface{};
  if (kind == "flakes") {
    description.source = FlakesSurface{};
    description.interpolation = Interpolation::nearest;
  }
  if (kind == "scratches") description.source = ScratchesSurface{};
  return make_surface(description, nullptr);
}

std::vector<Query> random_queries(const Surface& surface, double sigma, double roughness, std::size_t count) {
  std::vector<Query> queries(count);
  for (std::size_t n = 0; n < count; ++n) {
    const auto random = [&](std::uint64_t stream) { return synthesis::random_unit(7, stream, n); };
    queries[n].footprint = make_footprint(surface, {random(0), random(1)}, sigma, sigma, 0);
    const double r = std::sqrt(-2 * std::log(1 - random(4))), phi = 2 * M_PI * random(5);
    const double r2 = std::sqrt(-2 * std::log(1 - random(6))), phi2 = 2 * M_PI * random(7);
    const Eigen::Vector2d m = queries[n].footprint.mean_uv;
    const long i = static_cast<long>(std::floor(m.x() * surface.width() + sigma * r2 * std::cos(phi2))),
               j = static_cast<long>(std::floor(m.y() * surface.height() + sigma * r2 * std::sin(phi2)));
    queries[n].half_vector =
        (surface.texel(i, j) + roughness * r * Eigen::Vector2d(std::cos(phi), std::sin(phi)))
            .cwiseMax(-1)
            .cwiseMin(1);
    queries[n].roughness = roughness;
  }
  return queries;
}

int run(int argc, char** argv) {
  Device device(0);
  const std::string kind = argv[1];
  const double roughness = std::atof(argv[2]);
  PyramidSettings settings;
  if (argc > 4) settings.precision.block_ratio = std::atof(argv[4]);
  if (argc > 5) settings.precision.cell_ratio = std::atof(argv[5]);
  if (argc > 6) settings.precision.cutoff_error = std::atof(argv[6]);
  if (argc > 7) settings.level_bytes = static_cast<std::size_t>(std::atof(argv[7]) * (1 << 20));
  const int checks = argc > 8 ? std::atoi(argv[8]) : 200;
  const Surface surface = make(kind);
  const reference::Oracle oracle(surface, 1e-4);
  PyramidEvaluator pyramid(device, surface, settings);
  settings.count_elements = true;
  PyramidEvaluator counter(device, surface, settings);
  for (char* p = argv[3]; *p;) {
    const double sigma = std::strtod(p, &p);
    if (*p == ',') ++p;
    const auto queries = random_queries(surface, sigma, roughness, 1 << 14);
    const auto choice = pyramid.choose(queries[0]);
    const bool slow = !choice;
    const auto batch = thinned(queries, slow ? 64 : 1);
    pyramid.evaluate(thinned(queries, 1024));
    double best = 1e9;
    for (int k = 0; k < 2; ++k) {
      const std::clock_t w = std::clock();
      pyramid.evaluate(batch);
      best = std::min(best, 0.5 * double(std::clock() - w) / CLOCKS_PER_SEC);
    }
    const auto few = thinned(queries, queries.size() / checks);
    const Stopwatch w;
    const double error = relative_l2(pyramid.evaluate(few), oracle.evaluate(few));
    const double t = w.seconds();
    double count = 0;
    if (choice) {
      const auto c = counter.evaluate(batch);
      count = std::accumulate(c.begin(), c.end(), 0.0) / c.size();
    }
    fmt::print(
        "{} r={} sigma={} block={} build={:.2f}s MiB={:.1f} {:.0f} q/s  elements={:.0f} error={:.3f}% "
        "(oracle {:.1f}s)\n",
        kind, roughness, sigma, choice ? choice->block : 0, pyramid.build_seconds(),
        pyramid.device_bytes() / 1048576.0, batch.size() / best, count, 100 * error, t);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace mica::bench

int main(int argc, char** argv) {
  return mica::bench::run(argc, argv);
}
