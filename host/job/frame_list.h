#pragma once

#include <string>
#include <vector>

#include "host/job/job.h"

namespace mica::host {

/// Frames of a job, each once, in their order: "A", "A-B", "A-BxN" (each N-th from A on), or several of these
/// with commas between.
/// @param given how messages name the text: "--frames 1-9".
/// Throws UsageError for what is none of these, and for frames that the job does not have.
std::vector<int> parse_frames(const std::string& text, const FrameSettings& frames, const std::string& given);

/// The shortest text that `parse_frames` reads so.
/// @param frames in ascending order.
std::string frame_list(const std::vector<int>& frames);

}  // namespace mica::host
