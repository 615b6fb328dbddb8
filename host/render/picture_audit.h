#pragma once

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
};

/// Integrates pixels again, drawn with probabilities that grow with their luminance: as sums of many small
/// footprints, with rays and shadows of their own, and densities by `triangles`; of ever more of them until
/// two references agree to a tenth of the job's tolerance.
/// @param image of the frame at which `built` is. Depends on the job, the frame and the image alone.
PictureAudit audit_picture(const BuiltJob& built, const Image& image);

}  // namespace mica::host
