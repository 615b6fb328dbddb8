#include "host/app/render_logs.h"

#include <fmt/format.h>
#include <signal.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <tuple>

#include "host/app/picture_names.h"
#include "host/base/leftovers.h"
#include "host/job/frame_list.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// One process that rendered, from its "started" on.
struct Run {
  std::string started, output, job, hash, version, host;
  int process = 0;
  bool ended = false;
  std::optional<std::pair<int, int>> range;
  std::map<int, LoggedFrame> frames;
};

std::vector<int> frames_of(const std::string& text, const std::optional<std::pair<int, int>>& range) {
  FrameSettings settings;
  if (range) settings.first = range->first, settings.last = range->second;
  return text.empty() ? std::vector<int>() : parse_frames(text, settings, text);
}

/// Puts the lines of one log together.
class LogReader {
 public:
  void read(const std::string& path) {
    std::ifstream stream(path);
    for (std::string line; std::getline(stream, line);) {
      const json event = json::parse(line, nullptr, false);
      if (!event.is_object()) continue;  // the process was killed in the middle of it
      try {
        take(event);
      } catch (const json::exception&) {  // a line that is none of ours
      } catch (const UsageError&) {       // frames that are no list
      }
    }
  }

  std::vector<Run> runs() {
    std::vector<Run> all = std::move(past_);
    for (auto& [who, run] : latest_) all.push_back(std::move(run));
    return all;
  }

 private:
  void take(const json& event) {
    const std::string kind = event.at("event"), time = event.at("time"), host = event.at("host");
    const int process = event.at("process");
    const auto who = std::make_pair(host, process);
    if (kind == "started") {
      if (const auto before = latest_.find(who); before != latest_.end())
        past_.push_back(std::move(before->second));
      latest_[who] = start(event, time, host, process);
      return;
    }
    const auto found = latest_.find(who);
    if (found == latest_.end()) return;
    Run& run = found->second;
    if (kind == "ended" || kind == "stopped") run.ended = true;
    if (event.contains("frame")) {
      tell(&run.frames[event.at("frame")], kind, event, time);
    } else if (kind == "failed") {
      run.ended = true;
      for (const int frame : frames_of(event.at("frames"), run.range))
        tell(&run.frames[frame], kind, event, time);
    }
  }

  static Run start(const json& event, const std::string& time, const std::string& host, int process) {
    Run run;
    run.started = time, run.host = host, run.process = process;
    run.output = fs::path(event.at("output").get<std::string>()).filename().string();
    run.job = event.at("job"), run.hash = event.at("hash"), run.version = event.at("mica");
    picture_names("", run.output);  // throws for what is none
    if (event.contains("range")) run.range.emplace(event["range"].at(0), event["range"].at(1));
    constexpr int most = 999999;  // as a job's
    if (run.range && (run.range->first < 0 || run.range->second > most)) run.range.reset();
    if (event.contains("rows"))
      run.ended = true;  // parts are no frames
    else
      for (const int frame : frames_of(event.at("frames"), run.range)) run.frames[frame].time = time;
    return run;
  }

  static void tell(LoggedFrame* frame, const std::string& kind, const json& event, const std::string& time) {
    frame->time = time;
    if (kind == "phase") {
      frame->state = LoggedFrame::State::rendering;
    } else if (kind == "progress") {
      frame->note = fmt::format("{} of {} rows", event.at("rows").get<int>(), event.at("of").get<int>());
    } else if (kind == "finished" || kind == "skipped") {
      frame->state = LoggedFrame::State::finished;
      frame->note.clear();
      if (event.contains("seconds")) frame->seconds = event["seconds"].get<double>();
    } else if (kind == "failed") {
      frame->state = LoggedFrame::State::failed;
      frame->note =
          fmt::format("{}: {}", event.at("kind").get<std::string>(), event.at("message").get<std::string>());
    }
  }

  std::map<std::pair<std::string, int>, Run> latest_;
  std::vector<Run> past_;
};

bool is_fresh(const fs::path& path) {
  std::error_code error;
  const auto written = fs::last_write_time(path, error);
  return !error && fs::file_time_type::clock::now() - written < std::chrono::minutes(1);
}

/// @param is_fresh whether the run's log was written to in the last minute.
bool lives(const Run& run, bool is_fresh) {
  if (run.ended) return false;
  if (run.host != host_name()) return is_fresh;
  return kill(run.process, 0) == 0 || errno == EPERM;
}

void add(const Run& run, bool is_fresh, LoggedSequence* sequence) {
  if (run.started > sequence->started) {
    sequence->started = run.started, sequence->job = run.job, sequence->hash = run.hash;
    sequence->version = run.version, sequence->range = run.range;
  }
  const bool alive = lives(run, is_fresh);
  for (const auto& [number, of_run] : run.frames) {
    LoggedFrame frame = of_run;
    const bool is_open =
        frame.state == LoggedFrame::State::rendering || frame.state == LoggedFrame::State::waiting;
    frame.lives = alive && is_open;
    frame.place = fmt::format("{}, process {}", run.host, run.process);
    LoggedFrame& known = sequence->frames[number];
    // Who lives has it; else the latest word counts.
    if (std::tie(known.lives, known.time) < std::tie(frame.lives, frame.time)) known = frame;
  }
}

}  // namespace

std::map<std::string, LoggedSequence> read_logs(const std::string& folder) {
  std::map<std::string, LoggedSequence> sequences;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() != ".jsonl") continue;
    LogReader reader;
    const bool fresh = is_fresh(entry->path());
    reader.read(entry->path().string());
    for (const Run& run : reader.runs()) add(run, fresh, &sequences[run.output]);
  }
  return sequences;
}

}  // namespace mica::host::app
