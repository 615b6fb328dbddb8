#pragma once

#include "host/surface/description.h"
#include "host/surface/map_pixels.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Reads a map file and turns its texels into normals. What was assumed, repaired or lost goes to the report.
///  - `unorm`, `signed`: 3 channels are a normal, normalised here; 2 channels are (n_x, n_y), and n_z >= 0
///  follows.
///  - `slope`: 2 channels, (-n_x / n_z, -n_y / n_z).
///  - `height`: the first channel times `height_scale`, in texels; central differences, periodic.
/// With green down the second channel changes its sign. Normals below or beyond the rim of the disk (n_z <= 0
/// or |s| > kRim) are moved to it. NaN, infinite and zero-length (below 0.01) texels are refused, or filled
/// from their neighbours inwards, as `file.invalid` says. Throws FileError (see read_map_pixels; invalid
/// texels) and UsageError (an encoding that does not fit the pixels, a height_scale that is not finite).
Surface load_map(const MapFile& file, Interpolation interpolation, SurfaceReport& report);

/// The second half of load_map: pixels to normals, row v near 0 first.
/// @param steps gets the steps between the values that the pixels tell, when it is not null.
std::vector<Eigen::Vector2d> decode_normals(const MapFile& file, const MapPixels& pixels,
                                            SurfaceReport& report, Surface::Steps* steps = nullptr);

}  // namespace mica::host
