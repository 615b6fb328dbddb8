// `pyramid` and `auto` on 2048^2 maps: error, speed, memory and build over footprints of 1 to 4096 texels,
// against the best fixed evaluator that keeps 1%, random footprints, in one run; and a zoom. Prints a table.
// Errors are relative L2 against `triangles`, which keeps 1e-4 of the oracle, of as many queries as are
// affordable, with their standard deviation in brackets.
//   pyramid_bench [SURFACE... | FILE...] [--quick] [--errors]
// --errors times nothing.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/bench_maps.h"
#include "host/base/stopwatch.h"
#include "host/measure/coherent.h"
#include "host/methods/auto/auto_evaluator.h"
#include "host/methods/auto/sampled_error.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/pyramid/pyramid_evaluator.h"
#include "host/methods/registry.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/surface/texel_footprint.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr int kRepeats = 11;
constexpr double kSecondsARepeat = 0.03;

/// Queries a second: the median of the repeats after a warm-up, on as many queries as take about 0.03 s; of
/// three repeats where four queries take ten times as long.
double rate(Evaluator* evaluator, const std::vector<Query>& queries) {
  std::size_t count = 4;
  double once = 0;
  // A driver may compile a kernel again for the first batch of a size.
  evaluator->evaluate({queries.begin(), queries.begin() + static_cast<long>(count)});
  for (; count < queries.size(); count = std::min(4 * count, queries.size())) {
    const Stopwatch watch;
    evaluator->evaluate({queries.begin(), queries.begin() + static_cast<long>(count)});
    once = watch.seconds();
    if (once > kSecondsARepeat) break;
  }
  const std::vector<Query> batch(queries.begin(), queries.begin() + static_cast<long>(count));
  std::vector<double> seconds;
  for (int repeat = 0; repeat < (once > 10 * kSecondsARepeat ? 3 : kRepeats); ++repeat) {
    const Stopwatch watch;
    evaluator->evaluate(batch);
    seconds.push_back(watch.seconds());
  }
  return static_cast<double>(count) / timing_of(seconds).median_seconds;
}

SampledError error_of(Evaluator* evaluator, const std::vector<Query>& queries,
                      const std::vector<float>& expected) {
  return sampled_error(evaluator->evaluate(queries), expected, 1);
}

/// In percent, with its standard deviation.
std::string in_percent(const SampledError& error) {
  return fmt::format("{:.3f}({:.3f})%", 100 * error.relative_l2, 100 * error.deviation);
}

/// Queries that errors are told from, and what `triangles` make of them: as many as take about 3 s, 16 at
/// least.
struct Compared {
  std::vector<Query> queries;
  std::vector<float> expected;
};
Compared compared(Evaluator* triangles, const std::vector<Query>& queries) {
  constexpr double affordable_seconds = 3;
  const Stopwatch watch;
  triangles->evaluate(thinned(queries, queries.size() / 4));
  const double count = std::clamp(4 * affordable_seconds / watch.seconds(), 16.0, 16384.0);
  Compared some;
  some.queries = thinned(queries, queries.size() / static_cast<std::size_t>(count));
  some.expected = triangles->evaluate(some.queries);
  return some;
}

struct Effort {
  bool quick = false;  ///< few footprints
  bool timed = true;
};

struct Fixed {
  std::string name;
  std::unique_ptr<Evaluator> evaluator;
};

/// What is measured on one surface at one roughness.
class Bench {
 public:
  Bench(Device& device, const std::string& name, double roughness, const Effort& effort);
  void run();

 private:
  void measure(double sigma);
  /// The fastest of the evaluators of texels that keep 1% here, and its rate.
  std::pair<std::string, double> best_fixed(const std::vector<Query>& queries, const Compared& some);
  const std::string& choice_of(const Query& query) const;
  std::string of_public_code(double sigma, double rate) const;

  std::string name_;
  double roughness_;
  Effort effort_;
  Surface surface_;
  TriangleEvaluator triangles_;
  PyramidEvaluator pyramid_;
  AutoEvaluator auto_, strict_;
  std::vector<Fixed> mixtures_;
  std::map<double, std::vector<Query>> queries_;  // by sigma
  std::map<double, double> pyramid_rates_, auto_rates_;
};

Bench::Bench(Device& device, const std::string& name, double roughness, const Effort& effort)
    : name_(name),
      roughness_(roughness),
      effort_(effort),
      surface_(make_named(name)),
      triangles_(device, surface_),
      pyramid_(device, surface_),
      auto_(device, surface_, 0.01),
      strict_(device, surface_, 0.001) {
  std::vector<double> sigmas = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096};
  if (effort.quick) sigmas = {8, 32, 128, 512};
  std::vector<Query> sample;
  for (const double sigma : sigmas) {
    queries_[sigma] = random_queries(surface_, sigma, roughness, 1 << 16);
    const std::vector<Query> some = thinned(queries_[sigma], (1 << 16) / AutoEvaluator::kMostSamples);
    sample.insert(sample.end(), some.begin(), some.end());
  }
  const Stopwatch watch;
  auto_.calibrate({sample});
  const double seconds = watch.seconds();
  strict_.calibrate({sample});
  fmt::print("{} {}: auto calibrated in {:.1f} s, for 0.1% in {:.1f} s\n", name, roughness, seconds,
             watch.seconds() - seconds);
  for (const int elements : {1, 2, 4})
    mixtures_.push_back(
        {fmt::format("gaussians {}", elements),
         make_evaluator("gaussians", device, surface_, {{"elements", std::to_string(elements)}})});
}

void Bench::run() {
  for (const auto& [sigma, queries] : queries_) measure(sigma);
  fmt::print(
      "{} {}: all of the pyramid's levels built in {:.2f} s, {:.1f} MiB with the texels; auto's {:.1f} MiB\n",
      name_, roughness_, pyramid_.build_seconds(), static_cast<double>(pyramid_.device_bytes()) / (1 << 20),
      static_cast<double>(auto_.device_bytes()) / (1 << 20));
  if (effort_.timed)
    fmt::print("{} {}: queries/s at sigma 512 over those at 32: pyramid {:.2f}, auto {:.2f}\n\n", name_,
               roughness_, pyramid_rates_[512] / pyramid_rates_[32], auto_rates_[512] / auto_rates_[32]);
}

void Bench::measure(double sigma) {
  const std::vector<Query>& queries = queries_[sigma];
  const Compared some = compared(&triangles_, queries);
  const auto error = [&some](Evaluator* evaluator) {
    return in_percent(error_of(evaluator, some.queries, some.expected));
  };
  std::pair<std::string, double> fixed("-", 1);
  if (effort_.timed) {
    pyramid_rates_[sigma] = rate(&pyramid_, queries), auto_rates_[sigma] = rate(&auto_, queries);
    fixed = best_fixed(queries, some);
  }
  fmt::print("{:<10} {:>5} {:>5} {:>6}  {:>14} {:>10.0f}  {:>14} {:>10.0f} {:>7.2f}x  {:>14}  {:<12} {}{}\n",
             name_, roughness_, sigma, some.queries.size(), error(&pyramid_), pyramid_rates_[sigma],
             error(&auto_), auto_rates_[sigma], auto_rates_[sigma] / fixed.second, error(&strict_),
             fixed.first, choice_of(queries.front()), of_public_code(sigma, auto_rates_[sigma]));
  std::fflush(stdout);
}

std::pair<std::string, double> Bench::best_fixed(const std::vector<Query>& queries, const Compared& some) {
  const std::pair<std::string, double> best("triangles", rate(&triangles_, queries));
  for (const Fixed& mixture : mixtures_) {
    const double gaussians = rate(mixture.evaluator.get(), queries);
    if (gaussians < best.second) break;  // more elements are slower
    if (error_of(mixture.evaluator.get(), some.queries, some.expected).relative_l2 <= 0.01)
      return {mixture.name, gaussians};
  }
  return best;
}

const std::string& Bench::choice_of(const Query& query) const {
  const QueryClass kind = class_of(query, surface_.width(), surface_.height());
  for (const AutoChoice& choice : auto_.choices())
    if (!(choice.kind < kind) && !(kind < choice.kind)) return choice.evaluator;
  static const std::string none = "triangles";
  return none;
}

/// Public code on noise like `spectrum` at this roughness, random queries a second: [Yan16]'s own, whose
/// errors were 20, 14, 6 and 4%, and the position-normal manifolds of 2025 with clusters, 133, 68, 27 and
/// 42%, and without. Measured on another machine, whose peak (450 GFLOP/s) may be twice this one's.
std::string Bench::of_public_code(double sigma, double rate) const {
  struct Published {
    double sigma, yan16, manifolds, unclustered;
  };
  if (name_ != "spectrum" || roughness_ != 0.005 || !effort_.timed) return "";
  for (const Published& row : {Published{2, 160e3, 809e3, 547e3}, Published{8, 36e3, 220e3, 86e3},
                               Published{32, 3.3e3, 36e3, 8.5e3}, Published{128, 220, 11e3, 600}})
    if (row.sigma == sigma)
      return fmt::format("; {:.1f}x [Yan16]'s code, {:.2f}x manifolds with clusters, {:.1f}x without",
                         rate / row.yan16, rate / row.manifolds, rate / row.unclustered);
  return "";
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
    if (frame > 0) changes[frame] = sampled_error(densities, last, 1).relative_l2;
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
  const Stopwatch watch;
  Device device(0);
  if (names.empty()) names = {"spectrum", "brushed", "flakes", "scratches"};
  fmt::print(
      "device {}; random footprints, wall clock, median of {}\n"
      "[Yan16]'s code and manifolds: as measured on another machine, of twice the peak\n\n",
      device.info().name, kRepeats);
  fmt::print("{:<10} {:>5} {:>5} {:>6}  {:>14} {:>10}  {:>14} {:>10} {:>8}  {:>14}  {:<12} {}\n", "surface",
             "rough", "sigma", "of", "pyramid", "queries/s", "auto 1%", "queries/s", "of best", "auto 0.1%",
             "best fixed", "auto's choice");
  for (const std::string& name : names)
    for (const double roughness : {0.02, 0.005}) Bench(device, name, roughness, effort).run();
  for (const std::string& name : names) zoom(device, name, 0.02);
  fmt::print("{:.0f} s in all\n", watch.seconds());
  return 0;
}

}  // namespace
}  // namespace mica::host::bench

int main(int argc, char** argv) {
  try {
    std::vector<std::string> names(argv + 1, argv + argc);
    const auto taken = [&names](const char* option) {
      const auto found = std::remove(names.begin(), names.end(), option);
      const bool given = found != names.end();
      names.erase(found, names.end());
      return given;
    };
    mica::host::bench::Effort effort;
    effort.quick = taken("--quick");
    effort.timed = !taken("--errors");
    return mica::host::bench::run(names, effort);
  } catch (const mica::Error& error) {
    fmt::print(stderr, "pyramid_bench: {}\n", error.what());
    return 1;
  }
}
