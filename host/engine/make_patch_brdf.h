#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/engine/patch_brdf.h"
#include "host/surface/surface.h"

namespace mica {

/// Where a patch BRDF's masking and projected areas come from.
enum class Masking {
  exact,     ///< every lobe under the footprint. [Che18] Eqs. 10-17
  filtered,  ///< one lobe that has the moments of the footprint's slopes. [Che18] sec. 4.2.2
  geometric  ///< one roughness for the whole map, and cosines to the geometric normal. [Yan14] Eq. 1
};

/// "exact", "filtered" and "geometric", in the order of Masking.
const std::vector<std::string>& masking_names();

struct PatchBrdfSettings {
  Masking masking = Masking::exact;
  int elements = 1;  ///< of a mixture, a texel and axis
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

}  // namespace mica
