#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mica/control.h"
#include "mica/device.h"
#include "mica/method.h"

namespace mica::host {
struct Job;
}

MICA_BEGIN_NAMESPACE

/// A picture in memory: rows from the top, pixels from the left, their channels side by side.
struct MICA_API Image {
  int width = 0, height = 0;
  std::vector<std::string> channels;            ///< "R", "G", "B", "ndf.Y", ...
  std::vector<float> pixels;                    ///< width * height * channels
  std::map<std::string, std::string> metadata;  ///< job, frame, device, audit
  std::vector<std::string> notes;               ///< what was assumed, and what that cost
  double exposure_stops = 0;                    ///< of its preview, as the job has it
  std::string tone_map = "shoulder";            ///< of its preview: clamp, shoulder, reinhard or filmic

  /// All of one channel, width * height numbers. Throws UsageError for a name that is not there.
  std::vector<float> channel(const std::string& name) const;
};

/// Writes FILE.exr with all channels, or FILE.png for the eye; whole or not at all. Throws FileError, and
/// UsageError for another ending or tone map. @param exposure_stops more than the image's own.
MICA_API void write(const Image& image, const std::string& path, double exposure_stops = 0);

/// A job: a scene and what is wanted of it, docs/job.md. Copies share it.
class MICA_API Job {
 public:
  /// Reads a file. @param overrides `key.path=value`, as of `mica render --set`. Throws FileError, and
  /// UsageError with everything that is wrong, a line each.
  static Job load(const std::string& path, const std::vector<std::string>& overrides = {},
                  const Methods& methods = {});
  /// The same of a text. @param folder that file names in it are relative to.
  static Job parse(const std::string& text, const std::string& folder = ".",
                   const std::vector<std::string>& overrides = {}, const Methods& methods = {});

  int width() const;
  int height() const;
  int first_frame() const;
  int last_frame() const;
  /// What would be built, compiled and allocated, in words; builds nothing.
  std::string plan() const;

  explicit Job(std::shared_ptr<const host::Job> job);
  const std::shared_ptr<const host::Job>& implementation() const;

 private:
  std::shared_ptr<const host::Job> implementation_;
};

/// Renders the frames of a job. What they share is built once, at the first frame. Copies are the same
/// renderer; calls from several threads wait for each other.
class MICA_API Renderer {
 public:
  Renderer(const Device& device, const Job& job);

  /// One frame, the job's first unless told. An image depends on the job and the frame alone. Progress counts
  /// rows.
  Image render(const RunControl& control = {}) const;
  Image render(int frame, const RunControl& control = {}) const;

  class Implementation;

 private:
  std::shared_ptr<Implementation> implementation_;
};

MICA_END_NAMESPACE
