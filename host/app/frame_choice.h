#pragma once

#include <string>
#include <vector>

#include "host/job/job.h"

namespace mica::host::app {

/// The frames that `--frames` asks for; where `text` is empty the environment's MICA_FRAMES counts, and where
/// that is empty, too, they are all. Throws UsageError, see parse_frames.
std::vector<int> chosen_frames(const std::string& text, const FrameSettings& frames);

/// "out/ocean.exr" of frame 7 is "out/ocean.0007.exr".
std::string numbered(const std::string& path, int frame);

}  // namespace mica::host::app
