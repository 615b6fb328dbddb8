#pragma once

#include <cstddef>
#include <vector>

#include "host/render/built_job.h"

namespace mica::host {

/// Pixels that no fit stands for are sums of samples; where a silhouette, the edge of a shadow or a sharp rim
/// crosses a glint, sixteen of them share it or miss it. Such pixels, few, have nearly all of a picture's
/// error. Where they may be off by more than the picture's tolerance allows a pixel, those of their samples
/// that differ much from their neighbours are replaced by others, twice as dense along both axes; if that
/// changes the pixel as much, of these again.
///
/// How much that is rests on pixels spread over the whole picture, and whether a pixel needs it on its own
/// samples: a pixel does not depend on what else is rendered.
class Refinement {
 public:
  /// At the frame of `built`, which must outlive it. Nothing is refined in pictures without fits.
  explicit Refinement(const BuiltJob& built);

  /// Tells the doubt of pixels of rows, and refines them: they are as fitted ones then, with nothing but
  /// radiance.
  /// @param densities in the order of their queries. @return how many queries that took.
  std::size_t refine(TracedRows* rows, const std::vector<float>& densities);

  std::size_t refined_pixels() const { return refined_; }   ///< so far
  std::size_t dropped_queries() const { return dropped_; }  ///< of those it took, see PendingBlock; so far

 private:
  const BuiltJob& built_;
  bool tells_doubts_ = false;  ///< of pixels of samples
  double most_change_ = 0;     ///< of a pixel's luminance; 0: none is refined
  std::size_t refined_ = 0, dropped_ = 0;
};

}  // namespace mica::host
