// How different two pictures are, to a sum of squares and to an eye.
#pragma once

#include <Eigen/Core>

#include "host/image/image.h"

namespace mica::host::bench {

/// Mean over pixels and R, G, B of (x - ref)^2 / (ref^2 + 0.01). Images of one size, with channels R, G, B.
double relative_mse(const Image& image, const Image& reference);

/// CIE L*a*b* (D65, 2 degrees) of linear Rec. 709 RGB in [0, 1].
Eigen::Vector3d lab_from_linear_rgb(const Eigen::Vector3d& rgb);

/// CIEDE2000 with unit weights. Sharma, Wu and Dalal, "The CIEDE2000 color-difference formula", Color
/// Research and Application 30(1), 2005.
double ciede2000(const Eigen::Vector3d& lab_1, const Eigen::Vector3d& lab_2);

/// CIEDE2000 of each pixel as write_png would display the two; 1 can just be seen, 100 is black to white.
struct DisplayDifference {
  std::vector<float> pixels;
  double mean = 0, percentile_95 = 0;
};
DisplayDifference display_difference(const Image& image, const Image& reference);

}  // namespace mica::host::bench
