#pragma once

#include <optional>
#include <string>

#include "host/device/device.h"
#include "host/engine/estimate.h"
#include "host/engine/render.h"
#include "host/job/job.h"

namespace mica {

/// The plan and what it is expected to take, as JSON text.
std::string plan_json(const Job& job, const Plan& plan, const std::optional<Estimate>& estimate);

/// What was done to render a job: plan, bytes, seconds by phase, queries/s, audit; JSON text.
std::string render_json(const Job& job, const DeviceInfo& device, const RenderResult& result);

/// The same for people, a few lines.
std::string render_summary(const DeviceInfo& device, const RenderResult& result);

}  // namespace mica
