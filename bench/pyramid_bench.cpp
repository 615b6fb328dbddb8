// `pyramid` and `auto` on 2048^2 maps: error, speed, memory and build over footprints of 1 to 4096 texels,
// against the best fixed evaluator that keeps 1%, random footprints, in one run; and a zoom. Prints a table.
// Errors are relative L2 against `triangles`, which keeps 1e-4 of the oracle.
//   pyramid_bench [SURFACE... | FILE...] [--quick] [--errors]
// --errors times nothing.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/bench_maps.h"
#include "host/base/error.h"
#include "host/base/stopwatch.h"
#include "host/bench/coherent.h"
#include "host/engine/accuracy.h"
#include "host/engine/auto_evaluator.h"
#include "host/engine/make_evaluator.h"
#include "host/engine/mixture_evaluator.h"
#include "host/engine/pyramid_evaluator.h"
#include "host/engine/triangle_evaluator.h"

namespace mica::bench {
namespace {

constexpr int kRepeats = 11;
constexpr double kSecondsARepeat = 0.03;

/// Queries a second: the median of the repeats after a warm-up, on as many queries as take about 0.03 s.
double rate(Evaluator* evaluator, const std::vector<Query>& queries) {
  std::size_t count = 4;
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

/// Queries that errors are told from: triangles take seconds for a few wide footprints.
std::size_t compared(double sigma) {
  return sigma > 128 ? 32 : sigma > 32 ? 128 : sigma > 8 ? 512 : 2048;
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
  std::pair<std::string, double> best_fixed(const std::vector<Query>& queries, const std::vector<Query>& few,
                                            const std::vector<float>& expected);
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
    const std::vector<Query> some = thinned(queries_[sigma], sigma > 32 ? 1024 : 64);
    sample.insert(sample.end(), some.begin(), some.end());
  }
  const Stopwatch watch;
  auto_.calibrate(sample);
  const double seconds = watch.seconds();
  strict_.calibrate(sample);
  fmt::print("{} {}: auto calibrated in {:.1f} s, for 0.1% in {:.1f} s\n", name, roughness, seconds,
             watch.seconds() - seconds);
  for (const int elements : {1, 2, 4})
    mixtures_.push_back(
        {fmt::format("gaussians {}", elements), make_evaluator("gaussians", device, surface_, elements)});
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
  const std::vector<Query> few = thinned(queries, queries.size() / compared(sigma));
  const std::vector<float> expected = triangles_.evaluate(few);
  const double pyramid_error = error_of(&pyramid_, few, expected),
               auto_error = error_of(&auto_, few, expected), strict_error = error_of(&strict_, few, expected);
  std::pair<std::string, double> fixed("-", 1);
  if (effort_.timed) {
    pyramid_rates_[sigma] = rate(&pyramid_, queries), auto_rates_[sigma] = rate(&auto_, queries);
    fixed = best_fixed(queries, few, expected);
  }
  fmt::print(
      "{:<10} {:>5} {:>5}  {:>8.3f}% {:>10.0f}  {:>8.3f}% {:>10.0f} {:>7.2f}x  {:>8.4f}%  {:<12} {}{}\n",
      name_, roughness_, sigma, 100 * pyramid_error, pyramid_rates_[sigma], 100 * auto_error,
      auto_rates_[sigma], auto_rates_[sigma] / fixed.second, 100 * strict_error, fixed.first,
      choice_of(queries.front()), of_public_code(sigma, auto_rates_[sigma]));
  std::fflush(stdout);
}

std::pair<std::string, double> Bench::best_fixed(const std::vector<Query>& queries,
                                                 const std::vector<Query>& few,
                                                 const std::vector<float>& expected) {
  std::pair<std::string, double> best("triangles", rate(&triangles_, queries));
  for (const Fixed& mixture : mixtures_) {
    if (error_of(mixture.evaluator.get(), few, expected) > 0.01) continue;
    const double gaussians = rate(mixture.evaluator.get(), queries);
    if (gaussians > best.second) best = {mixture.name, gaussians};
    break;  // more elements are slower
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
  const Stopwatch watch;
  Device device(0);
  if (names.empty()) names = {"spectrum", "brushed", "flakes", "scratches"};
  fmt::print(
      "device {}; random footprints, wall clock, median of {}\n"
      "[Yan16]'s code and manifolds: as measured on another machine, of twice the peak\n\n",
      device.info().name, kRepeats);
  fmt::print("{:<10} {:>5} {:>5}  {:>9} {:>10}  {:>9} {:>10} {:>8}  {:>9}  {:<12} {}\n", "surface", "rough",
             "sigma", "pyramid", "queries/s", "auto 1%", "queries/s", "of best", "auto 0.1%", "best fixed",
             "auto's choice");
  for (const std::string& name : names)
    for (const double roughness : {0.02, 0.005}) Bench(device, name, roughness, effort).run();
  for (const std::string& name : names) zoom(device, name, 0.02);
  fmt::print("{:.0f} s in all\n", watch.seconds());
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
    return mica::bench::run(names, effort);
  } catch (const mica::Error& error) {
    fmt::print(stderr, "pyramid_bench: {}\n", error.what());
    return static_cast<int>(error.code());
  }
}
