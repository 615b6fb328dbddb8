#include "host/app/frame_choice.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "host/job/frame_list.h"

namespace mica::host::app {

std::vector<int> chosen_frames(const std::string& text, const FrameSettings& frames) {
  if (!text.empty()) return parse_frames(text, frames, "--frames " + text);
  if (const char* variable = std::getenv("MICA_FRAMES"); variable && *variable)
    return parse_frames(variable, frames, std::string("MICA_FRAMES=") + variable);
  return parse_frames(fmt::format("{}-{}", frames.first, frames.last), frames, "");
}

std::string numbered(const std::string& path, int frame) {
  if (path.empty()) return path;
  const std::filesystem::path file(path);
  const std::string name = fmt::format("{}.{:04}{}", file.stem().string(), frame, file.extension().string());
  return (file.parent_path() / name).string();
}

}  // namespace mica::host::app
