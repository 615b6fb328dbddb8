#pragma once

#include <string>
#include <vector>

#include "host/image/image.h"
#include "host/render/built_job.h"

namespace mica::host {

/// How far a picture lies from what its own filter makes of the light: footprints with constant half vectors
/// or fitted ones, shared samples, and the methods' densities, together.
struct PictureAudit {
  int pixels = 0;           ///< that were drawn; 0: no audit
  double relative_l2 = 0;   ///< of luminance: sqrt(sum (Y - ref)^2 / sum ref^2), as these tell it
  double upper_bound = 0;   ///< of that of the whole picture, at 95% confidence, and of the reference's own
  int subpixels = 0;        ///< samples a pixel and axis of the reference
  double reference_l2 = 0;  ///< between it and one of half as many
  /// What of `relative_l2` comes from the methods' densities, from what footprints and samples stand for, and
  /// from the parts that lamps with an extent are cut into. Errors add up with their signs: so do these.
  double of_densities = 0, of_footprints = 0, of_lamps = 0;
};

/// Pixels that were integrated again: luminance as drawn, and as it should be. Each is scaled so that all
/// count as if they were as likely, whichever rows they are of.
struct AuditedPixels {
  std::vector<float> shown, expected;
  std::vector<float> own, exact;  ///< of the picture's footprints alone: by its methods, and by `triangles`
  std::vector<float> under_its_lamps;  ///< as `expected`, with lamps in the picture's parts
  int subpixels = 0;                   ///< as PictureAudit, of the finest
  double reference_l2 = 0;             ///< as PictureAudit, the largest
};

/// Integrates pixels again, drawn with probabilities that grow with their luminance: as sums of many small
/// footprints, with rays and shadows of their own, and densities by `triangles`; of ever more of them until
/// two references agree to a tenth of the job's tolerance.
/// @param image of the frame at which `built` is, whole or some rows of it, which have their share of the
/// job's pixels. Depends on the job, the frame and the image alone.
AuditedPixels audit_pixels(const BuiltJob& built, const Image& image);

/// Sums up pixels.
PictureAudit picture_audit(const AuditedPixels& pixels);

/// How an audit is written into a picture.
std::string describe(const PictureAudit& audit);

}  // namespace mica::host
