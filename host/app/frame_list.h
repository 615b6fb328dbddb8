#pragma once

#include <string>
#include <vector>

#include "host/job/job.h"

namespace mica::host::app {

/// The frames of a job that `--frames` asks for, each once, in their order: "A", "A-B", "A-BxN" (each N-th
/// from A on), or several of these with commas between. Where `text` is empty the environment's MICA_FRAMES
/// counts, and where that is empty, too, they are all. Throws UsageError for what is none of these, and for
/// frames that the job does not have.
std::vector<int> chosen_frames(const std::string& text, const FrameSettings& frames);

/// The shortest text that `chosen_frames` reads so.
/// @param frames in ascending order.
std::string frame_list(const std::vector<int>& frames);

/// "out/ocean.exr" of frame 7 is "out/ocean.0007.exr".
std::string numbered(const std::string& path, int frame);

}  // namespace mica::host::app
