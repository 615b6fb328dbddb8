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

}  // namespace mica::host
