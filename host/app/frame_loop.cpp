#include "host/app/frame_loop.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>

#include "host/app/progress.h"
#include "host/app/say.h"
#include "host/base/interrupt.h"
#include "host/base/stopwatch.h"
#include "host/image/stored_picture.h"
#include "host/render/part.h"
#include "host/report/report.h"

namespace mica::host::app {
namespace {

/// Whether a file is whole and has these attributes, and these rows.
bool shows(const std::string& path, const std::map<std::string, std::string>& identity,
           const std::optional<RowRange>& rows) {
  try {
    const Image image = read_stored_picture(path);
    for (const auto& [name, value] : identity) {
      const auto found = image.metadata.find(name);
      if (found == image.metadata.end() || found->second != value) return false;
    }
    return !rows || (image.first_row == rows->first && image.height == rows->count);
  } catch (const FileError&) {
    return false;
  }
}

std::uintmax_t bytes_of(const std::vector<std::string>& files) {
  std::uintmax_t bytes = 0;
  std::error_code ignored;
  for (const std::string& file : files)
    if (const std::uintmax_t size = std::filesystem::file_size(file, ignored); !ignored) bytes += size;
  return bytes;
}

std::vector<std::string> files_of(const PictureNames& names) {
  std::vector<std::string> files;
  for (const std::string& name : {names.exr, names.png})
    if (!name.empty()) files.push_back(name);
  return files;
}

}  // namespace

bool is_finished(const FrameLoopSettings& settings, int frame, const std::string& inputs) {
  const auto identity = picture_identity(settings.job, frame, inputs);
  const PictureNames names = names_of_frame(settings.names, settings.job, frame, settings.share);
  for (const std::string& file : files_of(names)) {
    check_interrupt();
    if (!shows(file, identity, settings.share.rows)) return false;
  }
  return true;
}

void FrameLoop::skip(int frame) {
  ++done_;
  report([&] { return skipped_json(frame); });
  settings_.log.write("skipped", {{"frame", frame}});
  if (!settings_.quiet) say("frame {} is finished\n", frame);
}

void FrameLoop::render(BuiltJob& built, int frame, const DeviceInfo& device) {
  try {
    render_and_write(built, frame, device);
    ++done_;
  } catch (const Error& error) {
    settings_.log.write("failed",
                        {{"frame", frame}, {"kind", word_of_kind(error.kind())}, {"message", error.what()}});
    if (!settings_.job.frames.given) throw;
    spdlog::error("frame {}: {}", frame, error.what());
    report([&] { return failure_json(frame, error.what()); });
    failed_ = exit_code_of(error.kind());
  }
}

std::string FrameLoop::json() const {
  return settings_.job.frames.given ? frames_json(reports_) : reports_.front();
}

ExitCode FrameLoop::exit_code() const {
  if (!failed_) return ExitCode::done;
  return done_ > 0 ? ExitCode::some_images_failed : *failed_;
}

void FrameLoop::render_and_write(BuiltJob& built, int frame, const DeviceInfo& device) {
  const Job& job = settings_.job;
  settings_.log.write("phase", {{"frame", frame}, {"phase", "render"}});
  Progress progress(job.frames.given ? fmt::format("rows of frame {}", frame) : "rows", settings_.quiet);
  Stopwatch since_told;
  RenderResult result = render_frame(
      built, frame, device,
      [&](int rows, int all) {
        check_interrupt();
        progress.update(rows, all);
        if (since_told.seconds() < 1) return;  // a log is for people and their tools
        settings_.log.write("progress", {{"frame", frame}, {"rows", rows}, {"of", all}});
        since_told = Stopwatch();
      },
      settings_.share.rows);
  say_once(result.surface_notes, result.surface_warnings);
  if (!settings_.share.is_all()) make_part(job, &result);
  write(frame, device, result);
}

void FrameLoop::write(int frame, const DeviceInfo& device, const RenderResult& result) {
  const Job& job = settings_.job;
  const PictureNames names = names_of_frame(settings_.names, job, frame, settings_.share);
  settings_.log.write("phase", {{"frame", frame}, {"phase", "write"}});
  if (!names.exr.empty()) write_exr(names.exr, result.image);
  if (!names.png.empty()) write_png(names.png, result.image, job.image.exposure, job.image.tone_map);
  const std::vector<std::string> files = files_of(names);
  nlohmann::json audit;
  if (result.audit.samples)
    audit = {{"samples", result.audit.samples},
             {"relative_l2", result.audit.relative_l2},
             {"maximum", result.audit.maximum}};
  settings_.log.write("finished", {{"frame", frame},
                                   {"files", files},
                                   {"bytes", bytes_of(files)},
                                   {"seconds", result.seconds.total},
                                   {"audit", audit}});
  report([&] { return render_json(job, device, result); });
  if (settings_.quiet) return;
  say("{}", render_summary(device, result));
  say("wrote     {}\n", fmt::join(files, " and "));
}

void FrameLoop::say_once(const std::vector<std::string>& notes, const std::vector<std::string>& warnings) {
  for (const std::string& note : notes)
    if (said_.count(note) == 0) spdlog::info("{}", note);
  for (const std::string& warning : warnings)
    if (said_.count(warning) == 0) spdlog::warn("{}", warning);
  said_ = {notes.begin(), notes.end()};
  said_.insert(warnings.begin(), warnings.end());
}

}  // namespace mica::host::app
