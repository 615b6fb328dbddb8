#pragma once

#include <string>

#include "host/job/job.h"

namespace mica::host::app {

/// Frames that are rendered, both included.
struct FrameRange {
  int first = 0, last = 0;
};

/// Of the job's frames those of `--frames`, "A-B" or "A"; all of them when `text` is empty. Throws UsageError
/// for what is neither, and for frames that the job does not have.
FrameRange choose_frames(const std::string& text, const FrameSettings& frames);

/// "out/ocean.exr" of frame 7 is "out/ocean.0007.exr".
std::string numbered(const std::string& path, int frame);

}  // namespace mica::host::app
