#include "host/app/ledger.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <set>

#include "host/app/frame_choice.h"
#include "host/app/picture_names.h"
#include "host/app/render_logs.h"
#include "host/image/stored_picture.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

namespace fs = std::filesystem;

constexpr int kThumbnailSide = 160;  // pixels

/// Frame 7 of "ocean.0007.exr", whose output is "ocean.exr"; no frame of "ocean.exr".
struct PictureFile {
  std::string output;
  std::optional<int> frame;
};
PictureFile parse_name(const fs::path& path) {
  const std::string stem = path.stem().string(), number = fs::path(stem).extension().string();
  int frame = 0;
  const char* const end = number.data() + number.size();
  if (number.size() < 5 || std::from_chars(number.data() + 1, end, frame).ptr != end)
    return {path.filename().string(), {}};
  return {fs::path(stem).stem().string() + path.extension().string(), frame};
}

/// Outputs whose pictures are in the folder, with the frames that are there.
std::map<std::string, std::set<int>> find_pictures(const std::string& folder) {
  std::map<std::string, std::set<int>> found;
  std::set<std::string> previews;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".exr") continue;
    const PictureFile file = parse_name(entry.path());
    const bool is_part =
        file.output.find(".part-") != file.output.npos || file.output.find(".rows-") != file.output.npos;
    if (!is_part && file.frame) found[file.output].insert(*file.frame);
  }
  return found;
}

/// Reads what one frame's files show; nothing unless they are whole.
std::optional<Image> read_whole(const PictureNames& names) {
  try {
    std::optional<Image> picture;
    for (const std::string& name : {names.png, names.exr})
      if (!name.empty()) picture = read_stored_picture(name);
    return picture;
  } catch (const FileError&) {
    return std::nullopt;
  }
}

std::string attribute(const Image& image, const std::string& name) {
  const auto found = image.metadata.find(name);
  return found == image.metadata.end() ? "" : found->second;
}

/// Puts files and logs of one output together.
class SequenceReader {
 public:
  SequenceReader(const std::string& folder, std::string output, const LoggedSequence& logged,
                 const std::set<int>& there, bool thumbnails)
      : logged_(logged), is_numbered_(logged.range || logged.started.empty()), thumbnails_(thumbnails) {
    status_.output = std::move(output);
    status_.job = logged.job;
    names_ = picture_names("", (fs::path(folder) / status_.output).string());
    std::pair<int, int> range(0, 0);
    if (logged.range)
      range = *logged.range;
    else if (is_numbered_ && !there.empty())
      range = {*there.begin(), *there.rbegin()};
    for (int frame = range.first; frame <= range.second; ++frame) {
      status_.frames.emplace_back();
      status_.frames.back().frame = frame;
    }
  }

  SequenceStatus read() {
    std::vector<std::string> jobs(status_.frames.size());
    tbb::parallel_for(std::size_t{0}, status_.frames.size(),
                      [&](std::size_t n) { jobs[n] = look_at(&status_.frames[n]); });
    const std::string expected =
        logged_.hash.empty() ? most_common(jobs) : logged_.hash + " " + logged_.version;
    for (std::size_t n = 0; n < jobs.size(); ++n) judge(jobs[n] == expected, &status_.frames[n]);
    return std::move(status_);
  }

 private:
  PictureNames names_of(int frame) const {
    if (!is_numbered_) return names_;
    return {numbered(names_.exr, frame), numbered(names_.png, frame)};
  }

  /// @return hash and version of the job that made the frame; empty when its files are not whole.
  std::string look_at(FrameStatus* frame) const {
    const std::optional<Image> picture = read_whole(names_of(frame->frame));
    if (!picture) return {};
    if (is_numbered_ && attribute(*picture, "mica:frame") != fmt::format("{}", frame->frame)) return {};
    if (thumbnails_) frame->thumbnail = thumbnail_of(*picture, kThumbnailSide);
    return attribute(*picture, "mica:job") + " " + attribute(*picture, "mica:version");
  }

  static std::string most_common(const std::vector<std::string>& jobs) {
    std::map<std::string, int> counts;
    for (const std::string& job : jobs)
      if (!job.empty()) ++counts[job];
    const auto most = std::max_element(counts.begin(), counts.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == counts.end() ? "none" : most->first;
  }

  void judge(bool is_done, FrameStatus* frame) const {
    const auto found = logged_.frames.find(frame->frame);
    const LoggedFrame known = found == logged_.frames.end() ? LoggedFrame() : found->second;
    frame->seconds = known.seconds;
    if (is_done) {
      frame->state = FrameState::done;
    } else if (known.lives) {
      frame->state = FrameState::running;
      frame->note = fmt::format("{}{}{}", known.place, known.note.empty() ? "" : ": ", known.note);
      if (known.state == LoggedFrame::State::waiting) frame->note += ": later";
    } else if (known.state == LoggedFrame::State::failed) {
      frame->state = FrameState::failed, frame->note = fmt::format("{} ({})", known.note, known.place);
    } else if (known.state == LoggedFrame::State::rendering) {
      frame->state = FrameState::failed;
      frame->note = fmt::format("its process is gone ({})", known.place);
    }
    if (!is_done) frame->thumbnail.reset();
  }

  const LoggedSequence& logged_;
  bool is_numbered_, thumbnails_;
  PictureNames names_;
  SequenceStatus status_;
};

}  // namespace

std::vector<SequenceStatus> read_ledger(const std::string& folder, bool thumbnails) {
  if (!fs::is_directory(folder)) throw FileError(folder + ": no such folder");
  const std::map<std::string, LoggedSequence> logged = read_logs(folder);
  const std::map<std::string, std::set<int>> pictures = find_pictures(folder);
  std::set<std::string> outputs;
  for (const auto& [output, sequence] : logged) outputs.insert(output);
  for (const auto& [output, frames] : pictures) outputs.insert(output);
  std::vector<SequenceStatus> all;
  const LoggedSequence nothing;
  const std::set<int> none;
  for (const std::string& output : outputs) {
    const auto known = logged.find(output);
    const auto there = pictures.find(output);
    all.push_back(SequenceReader(folder, output, known == logged.end() ? nothing : known->second,
                                 there == pictures.end() ? none : there->second, thumbnails)
                      .read());
  }
  return all;
}

}  // namespace mica::host::app
