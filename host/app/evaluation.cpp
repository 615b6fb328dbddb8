#include "host/app/evaluation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "host/app/progress.h"
#include "host/base/chunks.h"
#include "host/base/interrupt.h"
#include "host/methods/shared_evaluator.h"
#include "mica/error.h"

namespace mica::host::app {
OpenEvaluator open_evaluator(const Method& method, const MethodSettings& settings, const DeviceOption& device,
                             const Surface* surface) {
  method.check(settings);
  OpenEvaluator open;
  if (method.traits().device) open.device = std::make_unique<Device>(device.index());
  open.evaluator = method.make(open.device.get(), surface, settings);
  return open;
}

OpenEvaluator open_shared_evaluator(const Method& method, const MethodSettings& settings,
                                    const DeviceOption& devices, const Surface* surface) {
  method.check(settings);
  if (!method.traits().device) return open_evaluator(method, settings, devices, surface);
  OpenEvaluator open;
  std::vector<Device*> all;
  for (const int index : devices.indices()) {
    auto device = std::make_unique<Device>(index);
    all.push_back(device.get());
    if (!open.device)
      open.device = std::move(device);
    else
      open.further.push_back(std::move(device));
  }
  open.evaluator = make_on(all, method, surface, settings);
  return open;
}

std::string device_names(const OpenEvaluator& open) {
  if (!open.device) return "the host";
  std::set<std::string> names = {open.device->info().name};
  for (const auto& device : open.further) names.insert(device->info().name);
  return fmt::format("{}", fmt::join(names, "; "));
}

void log_choices(const OpenEvaluator& open) {
  for (const AutoChoice& choice : open.evaluator->choices())
    spdlog::info("{}: {}", open.evaluator->name(), words(choice));
}

nlohmann::json describe_choices(const OpenEvaluator& open) {
  nlohmann::json list = nlohmann::json::array();
  for (const AutoChoice& choice : open.evaluator->choices())
    list.push_back({{"footprint_texels", std::exp2(choice.kind.size)},
                    {"roughness", 0.02 * std::exp2(0.5 * choice.kind.roughness)},
                    {"first_order", choice.kind.first_order},
                    {"evaluator", choice.evaluator},
                    {"samples", choice.samples},
                    {"relative_l2", choice.relative_l2},
                    {"upper_bound", choice.upper_bound}});
  return list;
}

void work_with_progress(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work) {
  Progress progress("queries", false);
  const Stopwatch watch;
  work_in_chunks(count, work, [&](std::size_t done) {
    check_interrupt();
    if (watch.seconds() > 1) progress.update(static_cast<long>(done), static_cast<long>(count));
  });
}

void evaluate_all(Evaluator* evaluator, std::size_t count, const std::function<Query(std::size_t)>& query,
                  const std::function<void(const std::vector<float>&)>& take) {
  std::vector<Query> queries;
  work_with_progress(count, [&](std::size_t first, std::size_t some) {
    queries.resize(some);
    for (std::size_t n = 0; n < some; ++n) queries[n] = query(first + n);
    take(evaluator->evaluate(queries));
  });
}

void check_extension(const std::string& path, const std::vector<std::string>& extensions) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end())
    throw UsageError(
        fmt::format("{}: expected a file name that ends in {}", path, fmt::join(extensions, " or ")));
}

}  // namespace mica::host::app
