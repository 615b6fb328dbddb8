#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/grid/grid_query.h"
#include "host/surface/surface.h"

namespace mica::host::app {

/// Names that `--ndf` takes: every evaluator, and `reference`.
std::vector<std::string> ndf_names();

/// An evaluator, and the device that it needs.
struct OpenEvaluator {
  std::unique_ptr<Device> device;  ///< null for `reference`, which runs on the host
  std::unique_ptr<Evaluator> evaluator;
};

/// @param name one of ndf_names(); `reference` is the oracle in double precision.
/// @param tolerance relative error asked for, none: the evaluator's own.
/// @param device_index as `mica devices` prints it.
/// @param surface has to outlive the evaluator.
/// @param elements of a mixture, a texel and axis.
/// Throws DeviceError, and UsageError for a tolerance that the evaluator cannot keep.
OpenEvaluator open_evaluator(const std::string& name, std::optional<double> tolerance, int device_index,
                             const Surface& surface, int elements);

/// For `auto`: chooses by a sample of queries 0 .. count - 1, and logs the choices. Others need none.
/// @param scale how many queries each of these stands for.
void calibrate(const OpenEvaluator& open, const Surface& surface, std::size_t count,
               const std::function<Query(std::size_t)>& query, double scale = 1);

/// What `auto` chose for each kind of query; empty for others.
nlohmann::json describe_choices(const OpenEvaluator& open);

/// `grid`, which needs no surface.
OpenEvaluator open_grid(const GlintGrid& grid, int device_index);

/// Throws UsageError when evaluator `name` cannot keep a relative error of `tolerance`.
void check_tolerance(const std::string& name, std::optional<double> tolerance);

/// Calls `work(first, count)` for successive chunks of 0 .. count - 1, each of about a second, between which
/// it checks for interrupts; shows progress on stderr once it has taken a second.
void work_in_chunks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work);

/// Densities of queries 0 .. count - 1, in chunks.
std::vector<float> evaluate_all(Evaluator* evaluator, std::size_t count,
                                const std::function<Query(std::size_t)>& query);

/// Throws UsageError unless `path` ends in one of `extensions`.
void check_extension(const std::string& path, const std::vector<std::string>& extensions);

}  // namespace mica::host::app
