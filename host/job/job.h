#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/image/image.h"
#include "host/methods/registry.h"
#include "host/scene/description.h"
#include "host/scene/pixel_filter.h"
#include "host/surface/description.h"
#include "mica/error.h"

namespace mica::host {

struct ImageSettings {
  int width = 1280, height = 720;
  FilterDescription filter{FilterKind::gaussian};  ///< of pixels
  int subpixels = 4;              ///< samples a pixel and axis, where one footprint will not do
  int samples = 16;               ///< directions a subpixel in which light from all around is gathered
  int max_bounces = 1;            ///< reflections of light on its way to the camera, at most
  std::vector<std::string> aovs;  ///< any of ndf, uv, footprint, normal, queries and error
  double exposure = 0;            ///< exposure of the PNG preview, in stops
  ToneMap tone_map = ToneMap::shoulder;
};

/// `[frames]`
struct FrameSettings {
  int first = 0, last = 0;  ///< both included
  double rate = 24;         ///< a second
  bool given = false;       ///< the job has the table: its images are numbered

  double seconds(int frame) const { return frame / rate; }
};

struct AuditSettings {
  int samples = 0;  ///< queries of the job that the oracle re-evaluates
  int pixels = 0;   ///< of the picture that are integrated again
};

struct AccuracySettings {
  double tolerance = 0.01;  ///< relative L2 that materials keep whose method takes one
  int lamp_parts = 1;       ///< into which a lamp with extent may be cut to keep it, 1..kMostLampParts
};

/// A validated job: everything in range, every name resolved, every input file present.
struct Job {
  std::string path;
  std::uint64_t hash = 0;  ///< hash of the text and the overrides
  std::uint64_t seed = 1;
  ImageSettings image;
  FrameSettings frames;
  SceneDescription scene;
  std::vector<SurfaceDescription> surfaces;
  AuditSettings audit;
  AccuracySettings accuracy;
  MethodRegistry methods;  ///< that its materials name
};

/// One mistake in a job file or in an override.
struct JobIssue {
  std::string file;          ///< the job file as it was named, or `--set key=value`
  int line = 0, column = 0;  ///< from 1, columns in code points; 0 in an override
  std::string message;       ///< what was found and what was expected
};

/// Everything that is wrong with a job: issues of the file by line and column, then those of overrides.
/// The message has one line an issue, `file:line:column: message`.
class JobError : public UsageError {
 public:
  explicit JobError(std::vector<JobIssue> issues);
  const std::vector<JobIssue>& issues() const { return issues_; }

 private:
  std::vector<JobIssue> issues_;
};

/// What a job is read for: a picture of its own, or a layer of glints over the picture of another renderer,
/// which brings camera, lights and shapes; then those that the job has are left out, and so is its image.
enum class JobUse { picture, layer };

/// Reads and validates a job.
///
/// @param path TOML, at most 1 MiB. File names in it are relative to its folder.
/// @param overrides `key.path=value` of --set, applied in order before validation. A number in the path is an
/// index,
///   from 0, into an array (`light.0.position=[0, 0, 4]`). The value is TOML; what is not is taken as a
///   string.
/// @throws FileError when `path` cannot be read; JobError with *all* issues otherwise. A file that the job
/// names
///   and that is not there is an issue of the job, reported where it is named.
/// @param methods that materials may name.
/// @param max_picture_bytes that reading one of its images may take; 0: half of the machine's memory.
Job load_job(const std::string& path, const std::vector<std::string>& overrides,
             const MethodRegistry& methods = MethodRegistry::builtin(), std::uint64_t max_picture_bytes = 0,
             JobUse use = JobUse::picture);

}  // namespace mica::host
