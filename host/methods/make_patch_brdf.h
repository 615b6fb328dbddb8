#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/base/cavities.h"
#include "host/base/masking.h"
#include "host/device/device.h"
#include "host/methods/patch_brdf.h"
#include "host/surface/surface.h"

namespace mica::host {

/// "exact", "filtered" and "geometric", in the order of Masking.
const std::vector<std::string>& masking_names();

struct PatchBrdfSettings {
  Masking masking = Masking::exact;
  int elements = 1;  ///< of a mixture, or seeds of cavities, a texel and axis
  Compensation compensation = Compensation::diffuse;  ///< of cavities
  LostEnergy energy = LostEnergy::exact;              ///< of cavities
  std::optional<WaveForm> wave_form = {};             ///< of beckmanns; default: what suits the device
};

/// Names that `make_patch_brdf` takes.
const std::vector<std::string>& patch_brdf_names();

/// The patch BRDF of that name on `surface`. `device` must outlive it; the surface need not.
/// Throws UsageError for a name that does not exist, and for a surface or number of elements that it does not
/// take.
std::unique_ptr<PatchBrdf> make_patch_brdf(const std::string& name, Device& device, const Surface& surface,
                                           const PatchBrdfSettings& settings = {});

/// Why a patch BRDF cannot answer for this view ("covariance is not positive definite"), or empty when it
/// can; directions have to be unit. A direction at or below the horizon is no problem: nothing is seen there.
std::string view_problem(const ViewQuery& query, int map_width, int map_height);

}  // namespace mica::host
