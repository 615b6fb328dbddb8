#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/job/job.h"
#include "host/render/estimate.h"
#include "host/render/render.h"

namespace mica::host {

/// The plan and what it is expected to take, as JSON text.
std::string plan_json(const Job& job, const Plan& plan, const std::optional<Estimate>& estimate);

/// What was done to render a job: plan, bytes, seconds by phase, queries/s, audit; JSON text.
std::string render_json(const Job& job, const DeviceInfo& device, const RenderResult& result);

/// What stands for a frame that failed, in the place of what was done.
std::string failure_json(int frame, const std::string& error);

/// What stands for a frame that was there.
std::string skipped_json(int frame);

/// The texts of all frames, in order, as one.
std::string frames_json(const std::vector<std::string>& frames);

/// What was done, for people: a few lines.
std::string render_summary(const DeviceInfo& device, const RenderResult& result);

}  // namespace mica::host
