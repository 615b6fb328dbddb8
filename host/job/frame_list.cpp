#include "host/job/frame_list.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cstdint>
#include <optional>
#include <set>

#include "mica/error.h"

namespace mica::host {
namespace {

std::optional<int> to_number(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 0) return std::nullopt;
  return number;
}

/// Each `step`-th frame from `first` to `last`.
struct FrameRun {
  int first = 0, last = 0, step = 1;
};

/// "A", "A-B" or "A-BxN".
std::optional<FrameRun> parse_run(std::string_view text) {
  const std::size_t dash = text.find('-');
  const std::optional<int> first = to_number(text.substr(0, dash));
  if (dash == text.npos) return first ? std::optional<FrameRun>({*first, *first, 1}) : std::nullopt;
  const std::string_view rest = text.substr(dash + 1);
  const std::size_t times = rest.find('x');
  const std::optional<int> last = to_number(rest.substr(0, times));
  const std::optional<int> step = times == rest.npos ? 1 : to_number(rest.substr(times + 1));
  if (!first || !last || !step || *first > *last || *step < 1) return std::nullopt;
  return FrameRun{*first, *last, *step};
}

}  // namespace

std::vector<int> parse_frames(const std::string& list, const FrameSettings& frames,
                              const std::string& given) {
  std::set<int> chosen;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::optional<FrameRun> run = parse_run(std::string_view(list).substr(begin, end - begin));
    if (!run)
      throw UsageError(
          fmt::format("{}: expected A, A-B or A-BxN, A not above B, or several with commas", given));
    if (run->first < frames.first || run->last > frames.last) {
      const std::string range = frames.first == frames.last
                                    ? fmt::format("one frame, {}", frames.first)
                                    : fmt::format("frames {} to {}", frames.first, frames.last);
      throw UsageError(fmt::format("{}: the job has {}", given, range));
    }
    for (std::int64_t frame = run->first; frame <= run->last; frame += run->step)
      chosen.insert(static_cast<int>(frame));
    begin = end + 1;
  }
  return {chosen.begin(), chosen.end()};
}

std::string frame_list(const std::vector<int>& frames) {
  std::vector<std::string> runs;
  for (std::size_t first = 0; first < frames.size();) {
    const int step = first + 1 < frames.size() ? frames[first + 1] - frames[first] : 1;
    std::size_t last = first;
    while (last + 1 < frames.size() && frames[last + 1] - frames[last] == step) ++last;
    if (last - first < 2 && step > 1) last = first;  // two frames are no run, unless they are neighbours
    runs.push_back(last == first ? fmt::format("{}", frames[first])
                                 : fmt::format("{}-{}{}", frames[first], frames[last],
                                               step > 1 ? fmt::format("x{}", step) : ""));
    first = last + 1;
  }
  return fmt::format("{}", fmt::join(runs, ","));
}

}  // namespace mica::host
