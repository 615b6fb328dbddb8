#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/image/image.h"
#include "host/job/job.h"
#include "host/render/audit.h"
#include "host/render/built_job.h"
#include "host/render/film.h"
#include "host/render/picture_audit.h"
#include "host/render/plan.h"

namespace mica::host {

/// Wall-clock seconds by phase. `render` is tracing and evaluating together, which overlap; `trace` and
/// `wait` are the host's shares of it: tracing rows, and waiting for densities that were not ready; `gather`
/// is gathering light from all around, on both; `refine` sampling pixels more densely, likewise.
struct PhaseSeconds {
  double surfaces = 0, scene = 0, build = 0, render = 0, trace = 0, gather = 0, refine = 0, wait = 0,
         audit = 0;
  double total = 0;
};

/// A finished image and what was done to make it.
struct RenderResult {
  int frame = 0;
  Image image;
  Plan plan;
  PhaseSeconds seconds;
  std::size_t queries = 0;
  std::size_t dropped_queries = 0;  ///< of these, those that no normal could answer; see LitNormals
  std::size_t refined_pixels = 0;   ///< see Refinement
  double lamps_error = 0;           ///< estimate of the relative L2 for lamps' extent, see GlintQuery
  std::size_t device_bytes = 0;     ///< of all structures, as allocated
  double device_seconds = 0;        ///< that kernels ran, by the device's clock
  std::vector<AuditedSample> audited;
  AuditedPixels audited_pixels;
  AuditResult audit;  ///< of queries
  PictureAudit picture_audit;
  FilmRepairs repairs;
  double precision_error = 0;        ///< of maps, by the steps of their files: BuiltJob::precision_error
  std::size_t replaced_answers = 0;  ///< that were not finite: the oracle's, or 0 of a BRDF
  std::vector<std::string> surface_notes, surface_warnings;
};

/// Rows of a picture, counted from the top.
struct RowRange {
  int first = 0, count = 0;
};

/// What a picture's file says of what it shows, by attribute: two files with the same are the same picture.
/// @param inputs as hash_of_inputs.
std::map<std::string, std::string> picture_identity(const Job& job, int frame, const std::string& inputs);

/// How an audit is written into a picture.
std::string describe(const AuditResult& audit);

/// Called after every block of rows with the rows done; may throw to stop.
using RenderProgress = std::function<void(int rows_done, int rows)>;

/// What is known of a block of rows once they are evaluated; densities and errors in the order of their
/// queries, the latter empty unless the plan has a channel for them.
using TakeRows = std::function<void(const TracedRows& rows, const std::vector<float>& densities,
                                    const std::vector<float>& errors)>;

/// Traces and evaluates rows of one frame, and hands them out from the top. As render_frame; of the result
/// image, repairs and pixels' audit are the caller's.
RenderResult evaluate_frame(BuiltJob& built, int frame, const DeviceInfo& device,
                            const RenderProgress& progress, const RowRange& rows, const TakeRows& take);

/// Says in the result's warnings what answers and `repairs` were no numbers.
void tell_repairs(const FilmRepairs& repairs, RenderResult* result);

/// Renders one frame of a job by its plan: traces blocks of rows on the host while the device evaluates the
/// block before. The image depends on the job and the frame alone, bit for bit. Throws mica::Error.
/// @param built at the job's first frame or at one that was rendered before. The first frame's seconds are
/// those of everything that it needs; later ones need what changed.
/// @param rows the only ones that are rendered; none: all.
RenderResult render_frame(BuiltJob& built, int frame, const DeviceInfo& device,
                          const RenderProgress& progress, std::optional<RowRange> rows = {});

/// Renders the first frame of a job.
RenderResult render(const Job& job, const Plan& plan, Device& device, const RenderProgress& progress);

}  // namespace mica::host
