#include "host/report/sequence_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/report/page_images.h"
#include "host/report/svg.h"

namespace mica::host {
namespace {

constexpr char kHead[] = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{0}</title><style>
body {{ font-family: sans-serif; margin: 2em; }}
.frames {{ display: flex; flex-wrap: wrap; gap: 6px; }}
.frame {{ border: 3px solid #999; padding: 3px; font-size: 75%; min-width: 5em; max-width: 170px; }}
.done {{ border-color: #009e73; }} .running {{ border-color: #56b4e9; }} .failed {{ border-color: #d55e00; }}
img {{ display: block; }}
</style></head><body><h1>{0}</h1>
)";

std::string frame_markup(const FrameStatus& frame) {
  const std::string state(word_of(frame.state));
  std::string text = fmt::format("<div class=\"frame {}\">", state);
  if (frame.thumbnail) text += picture_tag(*frame.thumbnail, 1, fmt::format("frame {}", frame.frame));
  text += fmt::format("{} {}", frame.frame, state);
  if (frame.seconds) text += fmt::format(", {:.1f} s", *frame.seconds);
  if (!frame.note.empty()) text += "<br>" + escape_markup(frame.note);
  return text + "</div>\n";
}

}  // namespace

int SequenceStatus::count(FrameState state) const {
  return static_cast<int>(std::count_if(frames.begin(), frames.end(),
                                        [&](const FrameStatus& frame) { return frame.state == state; }));
}

std::vector<int> SequenceStatus::remaining() const {
  std::vector<int> numbers;
  for (const FrameStatus& frame : frames)
    if (frame.state == FrameState::failed || frame.state == FrameState::missing)
      numbers.push_back(frame.frame);
  return numbers;
}

Image thumbnail_of(const Image& image, int side) {
  const int step = (std::max(image.width, image.height) + side - 1) / side;
  Image small;
  small.width = (image.width + step - 1) / step, small.height = (image.height + step - 1) / step;
  const std::size_t all = image.channels.size(), channels = all >= 3 ? 3 : 1;
  small.channels = channels == 3 ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"};
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x)
      for (std::size_t channel = 0; channel < channels; ++channel) {
        double sum = 0;
        int count = 0;
        for (int row = y * step; row < std::min((y + 1) * step, image.height); ++row)
          for (int column = x * step; column < std::min((x + 1) * step, image.width); ++column, ++count)
            sum += image.pixels[(static_cast<std::size_t>(row) * image.width + column) * all + channel];
        small.pixels.push_back(static_cast<float>(sum / count));
      }
  return small;
}

std::string sequence_page(const std::string& title, const std::vector<SequenceStatus>& sequences) {
  std::string page = fmt::format(kHead, escape_markup(title));
  for (const SequenceStatus& sequence : sequences) {
    page += fmt::format("<h2>{}</h2><p>{}{} frames", escape_markup(sequence.output),
                        sequence.job.empty() ? "" : "job " + escape_markup(sequence.job) + ": ",
                        sequence.frames.size());
    for (const Word<FrameState>& state : Words<FrameState>::all)
      page += fmt::format(", {} {}", sequence.count(state.value), state.word);
    page += "</p>\n<div class=\"frames\">\n";
    for (const FrameStatus& frame : sequence.frames) page += frame_markup(frame);
    page += "</div>\n";
  }
  return page + "</body></html>\n";
}

}  // namespace mica::host
