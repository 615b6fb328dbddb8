#include "host/app/evaluation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "host/app/progress.h"
#include "host/base/interrupt.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

OpenEvaluator open_evaluator(const Method& method, const MethodSettings& settings, int device_index,
                             const Surface* surface) {
  method.check(settings);
  OpenEvaluator open;
  if (method.traits().device) open.device = std::make_unique<Device>(device_index);
  open.evaluator = method.make(open.device.get(), surface, settings);
  return open;
}

void calibrate(const OpenEvaluator& open, std::size_t count, const std::function<Query(std::size_t)>& query,
               double scale) {
  open.evaluator->calibrate(count, query, scale);
  for (const AutoChoice& choice : open.evaluator->choices())
    spdlog::info(
        "{}: footprints of about {:.3g} texels, roughness from {:.3g}: {}; relative L2 {:.2g}, at most "
        "{:.2g}",
        open.evaluator->name(), std::exp2(choice.kind.size), 0.02 * std::exp2(0.5 * choice.kind.roughness),
        choice.evaluator, choice.relative_l2, choice.upper_bound);
}

nlohmann::json describe_choices(const OpenEvaluator& open) {
  nlohmann::json list = nlohmann::json::array();
  for (const AutoChoice& choice : open.evaluator->choices())
    list.push_back({{"footprint_texels", std::exp2(choice.kind.size)},
                    {"roughness", 0.02 * std::exp2(0.5 * choice.kind.roughness)},
                    {"evaluator", choice.evaluator},
                    {"samples", choice.samples},
                    {"relative_l2", choice.relative_l2},
                    {"upper_bound", choice.upper_bound}});
  return list;
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
