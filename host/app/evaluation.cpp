#include "host/app/evaluation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "host/app/interrupt.h"
#include "host/app/progress.h"
#include "host/methods/auto/auto_evaluator.h"
#include "host/methods/grid/grid_evaluator.h"
#include "host/methods/make_evaluator.h"
#include "host/reference/oracle.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kTrianglesTolerance = 1e-4;  // what `triangles` keeps, relative
constexpr double kAutoTolerance = 0.01;       // relative L2 that `auto` keeps unless it is told
constexpr double kMinOracleTolerance = 1e-12, kMaxOracleTolerance = 0.1;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class KnownDensities : public PendingDensities {
 public:
  explicit KnownDensities(std::vector<float> densities) : densities_(std::move(densities)) {}
  std::vector<float> wait() override { return std::move(densities_); }

 private:
  std::vector<float> densities_;
};

/// The oracle behind the interface of the devices' evaluators.
class ReferenceEvaluator : public Evaluator {
 public:
  ReferenceEvaluator(const Surface& surface, double tolerance) : oracle_(surface, tolerance) {
    build_seconds_ = seconds_since(start_);
  }

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override {
    const std::vector<reference::OracleResult> results = oracle_.evaluate(queries);
    std::vector<float> densities(results.size());
    std::transform(results.begin(), results.end(), densities.begin(),
                   [](const reference::OracleResult& result) { return static_cast<float>(result.density); });
    return std::make_unique<KnownDensities>(std::move(densities));
  }
  std::string name() const override { return "reference"; }
  std::size_t device_bytes() const override { return 0; }
  double build_seconds() const override { return build_seconds_; }
  double device_seconds() const override { return 0; }

 private:
  Clock::time_point start_ = Clock::now();
  reference::Oracle oracle_;
  double build_seconds_ = 0;
};

}  // namespace

std::vector<std::string> ndf_names() {
  std::vector<std::string> names = evaluator_names();
  names.push_back("auto");
  names.push_back("reference");
  return names;
}

void check_tolerance(const std::string& name, std::optional<double> tolerance) {
  if (!tolerance) return;
  if (name == "reference") {
    if (!(*tolerance >= kMinOracleTolerance && *tolerance <= kMaxOracleTolerance))
      throw UsageError(fmt::format("--tolerance {}: reference takes {} to {}", *tolerance,
                                   kMinOracleTolerance, kMaxOracleTolerance));
  } else if (name == "auto") {
    if (!(*tolerance >= AutoEvaluator::kLeastTolerance && *tolerance < 1))
      throw UsageError(fmt::format("--tolerance {}: auto takes {} to 1; for less use triangles or reference",
                                   *tolerance, AutoEvaluator::kLeastTolerance));
  } else if (name != "triangles") {
    throw UsageError(fmt::format("--tolerance {}: {} promises no error; auto, triangles and reference do",
                                 *tolerance, name));
  } else if (!(*tolerance >= kTrianglesTolerance)) {
    throw UsageError(
        fmt::format("--tolerance {}: {} keeps a relative error of {}; for less use --ndf reference",
                    *tolerance, name, kTrianglesTolerance));
  }
}

OpenEvaluator open_evaluator(const std::string& name, std::optional<double> tolerance, int device_index,
                             const Surface& surface, int elements) {
  check_tolerance(name, tolerance);
  OpenEvaluator open;
  if (name == "reference") {
    open.evaluator = std::make_unique<ReferenceEvaluator>(
        surface, tolerance.value_or(reference::Oracle::default_tolerance));
  } else {
    open.device = std::make_unique<Device>(device_index);
    open.evaluator = name == "auto" ? std::make_unique<AutoEvaluator>(*open.device, surface,
                                                                      tolerance.value_or(kAutoTolerance))
                                    : make_evaluator(name, *open.device, surface, elements);
  }
  return open;
}

void calibrate(const OpenEvaluator& open, const Surface& surface, std::size_t count,
               const std::function<Query(std::size_t)>& query, double scale) {
  auto* const chooser = dynamic_cast<AutoEvaluator*>(open.evaluator.get());
  if (chooser == nullptr) return;
  chooser->calibrate(calibration_sample(count, AutoEvaluator::kMostSamples, surface.width(), surface.height(),
                                        query, scale));
  for (const AutoChoice& choice : chooser->choices())
    spdlog::info(
        "auto: footprints of about {:.3g} texels, roughness from {:.3g}: {}; relative L2 {:.2g}, at most "
        "{:.2g}",
        std::exp2(choice.kind.size), 0.02 * std::exp2(0.5 * choice.kind.roughness), choice.evaluator,
        choice.relative_l2, choice.upper_bound);
}

nlohmann::json describe_choices(const OpenEvaluator& open) {
  nlohmann::json list = nlohmann::json::array();
  if (const auto* const chooser = dynamic_cast<const AutoEvaluator*>(open.evaluator.get());
      chooser != nullptr)
    for (const AutoChoice& choice : chooser->choices())
      list.push_back({{"footprint_texels", std::exp2(choice.kind.size)},
                      {"roughness", 0.02 * std::exp2(0.5 * choice.kind.roughness)},
                      {"evaluator", choice.evaluator},
                      {"samples", choice.samples},
                      {"relative_l2", choice.relative_l2},
                      {"upper_bound", choice.upper_bound}});
  return list;
}

OpenEvaluator open_grid(const GlintGrid& grid, int device_index) {
  OpenEvaluator open;
  open.device = std::make_unique<Device>(device_index);
  open.evaluator = std::make_unique<GridEvaluator>(*open.device, grid);
  return open;
}

void work_in_chunks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work) {
  constexpr std::size_t max_chunk = 1 << 20;  // queries; also bounds the host's memory
  Progress progress("queries", false);
  const Clock::time_point all_start = Clock::now();
  std::size_t chunk = 256;
  for (std::size_t first = 0; first < count;) {
    check_interrupt();
    const Clock::time_point start = Clock::now();
    const std::size_t some = std::min(chunk, count - first);
    work(first, some);
    first += some;
    const double seconds = seconds_since(start);
    if (seconds_since(all_start) > 1) progress.update(static_cast<long>(first), static_cast<long>(count));
    if (seconds < 0.5) chunk = std::min(2 * chunk, max_chunk);
    if (seconds > 2) chunk = std::max<std::size_t>(chunk / 2, 1);
  }
  check_interrupt();
}

std::vector<float> evaluate_all(Evaluator* evaluator, std::size_t count,
                                const std::function<Query(std::size_t)>& query) {
  std::vector<float> densities;
  densities.reserve(count);
  std::vector<Query> queries;
  work_in_chunks(count, [&](std::size_t first, std::size_t some) {
    queries.resize(some);
    for (std::size_t n = 0; n < some; ++n) queries[n] = query(first + n);
    const std::vector<float> answers = evaluator->evaluate(queries);
    densities.insert(densities.end(), answers.begin(), answers.end());
  });
  return densities;
}

void check_extension(const std::string& path, const std::vector<std::string>& extensions) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end())
    throw UsageError(
        fmt::format("{}: expected a file name that ends in {}", path, fmt::join(extensions, " or ")));
}

}  // namespace mica::host::app
