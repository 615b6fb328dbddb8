#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/app/device_option.h"
#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/method.h"
#include "host/surface/surface.h"

namespace mica::host::app {

/// An evaluator, and the devices that it needs.
struct OpenEvaluator {
  std::unique_ptr<Device> device;                ///< null for a method that runs on the host
  std::vector<std::unique_ptr<Device>> further;  ///< that share its work
  std::unique_ptr<Evaluator> evaluator;
};

/// @param device asked only for a method that needs one.
/// @param surface has to outlive the evaluator; null for a method without a map.
/// Throws DeviceError, and UsageError for settings that the method cannot keep.
OpenEvaluator open_evaluator(const Method& method, const MethodSettings& settings, const DeviceOption& device,
                             const Surface* surface);

/// The same on all devices that are given, which share its queries.
OpenEvaluator open_shared_evaluator(const Method& method, const MethodSettings& settings,
                                    const DeviceOption& devices, const Surface* surface);

/// The names of all its devices, each once, or "the host".
std::string device_names(const OpenEvaluator& open);

/// Logs what a method that chooses among others chose.
void log_choices(const OpenEvaluator& open);

/// What was chosen for each kind of query; empty for methods that choose nothing.
nlohmann::json describe_choices(const OpenEvaluator& open);

/// Calls `work(first, count)` for successive chunks of 0 .. count - 1, each of about a second, between which
/// it checks for interrupts; shows progress on stderr once it has taken a second.
void work_with_progress(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work);

/// Densities of queries 0 .. count - 1, in chunks, each of which `take` gets in their order.
void evaluate_all(Evaluator* evaluator, std::size_t count, const std::function<Query(std::size_t)>& query,
                  const std::function<void(const std::vector<float>&)>& take);

/// Throws UsageError unless `path` ends in one of `extensions`.
void check_extension(const std::string& path, const std::vector<std::string>& extensions);

}  // namespace mica::host::app
