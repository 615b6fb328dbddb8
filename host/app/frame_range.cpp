#include "host/app/frame_range.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <optional>

#include "mica/error.h"

namespace mica::host::app {
namespace {

std::optional<int> to_number(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 0) return std::nullopt;
  return number;
}

}  // namespace

FrameRange choose_frames(const std::string& text, const FrameSettings& frames) {
  if (text.empty()) return {frames.first, frames.last};
  const std::string_view view = text;
  const std::size_t dash = view.find('-');
  const std::optional<int> first = to_number(view.substr(0, dash));
  const std::optional<int> last = dash == view.npos ? first : to_number(view.substr(dash + 1));
  if (!first || !last || *first > *last)
    throw UsageError(fmt::format("--frames {}: expected A-B or A, A not above B", text));
  if (*first < frames.first || *last > frames.last) {
    const std::string range = frames.first == frames.last
                                  ? fmt::format("one frame, {}", frames.first)
                                  : fmt::format("frames {} to {}", frames.first, frames.last);
    throw UsageError(fmt::format("--frames {}: the job has {}", text, range));
  }
  return {*first, *last};
}

std::string numbered(const std::string& path, int frame) {
  if (path.empty()) return path;
  const std::filesystem::path file(path);
  const std::string name = fmt::format("{}.{:04}{}", file.stem().string(), frame, file.extension().string());
  return (file.parent_path() / name).string();
}

}  // namespace mica::host::app
