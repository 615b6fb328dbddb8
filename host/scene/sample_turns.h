#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "host/scene/viewer.h"

namespace mica::host {

/// A lamp's half vector's change a pixel to the right and down, at point k of a pixel of n x n: by
/// differences to its neighbours in the pixel that lie on the same surface in the lamp's light. None where it
/// has none along one of both axes, and towards rims, where nothing is linear over `sigma_pixels` any more.
std::optional<Eigen::Matrix2d> half_vector_change(const std::vector<SeenPoint>& points, int n, int k,
                                                  std::size_t lamp, double sigma_pixels);

/// What a Gaussian of `sigma_pixels` about point k of a pixel of n x n leaves out as its surface turns away
/// from the eye, or ends beside it: an estimate of the relative L2, at most 1. By the cosine between normal
/// and eye c, which uv pass by as 1 / c: half of what it changes by over the footprint, of itself.
double missed_by_bend(const std::vector<SeenPoint>& points, int n, int k, double sigma_pixels);

/// Which of some lights are seen from a point beside point k of a pixel of n x n.
std::vector<bool> lights_beside(const std::vector<SeenPoint>& points, int n, int k, std::size_t lights);

}  // namespace mica::host
