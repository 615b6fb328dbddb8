#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/app/exit_code.h"
#include "host/app/json_log.h"
#include "host/app/picture_names.h"
#include "host/render/render.h"

namespace mica::host::app {

/// What a frame loop renders, and how it tells of it; all has to outlive it.
struct FrameLoopSettings {
  const Job& job;
  const PictureNames& names;
  const PictureShare& share;
  JsonLog& log;
  bool quiet = false;
  bool keeps_reports = false;  ///< for `json`: a sequence may be long
};

/// Whether the files of a frame are whole and show what the job would have them show.
bool is_finished(const FrameLoopSettings& settings, int frame, const std::string& inputs);

/// Renders frames of a job one after the other, and keeps on when one fails.
class FrameLoop {
 public:
  explicit FrameLoop(const FrameLoopSettings& settings) : settings_(settings) {}

  /// What was found while surfaces and images were read, before a long rendering and not after it.
  void say_findings(const BuiltJob& built) { say_once(built.notes(), built.warnings()); }

  void skip(int frame);
  void render(BuiltJob& built, int frame, const DeviceInfo& device);

  /// The JSON of all frames, or of the only one.
  std::string json() const;
  ExitCode exit_code() const;

 private:
  void render_and_write(BuiltJob& built, int frame, const DeviceInfo& device);
  void write(int frame, const DeviceInfo& device, const RenderResult& result);
  template <typename Make>
  void report(const Make& make) {
    if (settings_.keeps_reports) reports_.push_back(make());
  }

  /// What was not said of the frame before.
  void say_once(const std::vector<std::string>& notes, const std::vector<std::string>& warnings);

  FrameLoopSettings settings_;
  std::set<std::string> said_;
  std::vector<std::string> reports_;
  int done_ = 0;
  std::optional<ExitCode> failed_;
};

}  // namespace mica::host::app
