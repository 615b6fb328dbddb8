#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mica::host {

/// A number for a place of an image `width` pixels wide; inside it that of the pixel, row * width + column.
std::uint64_t place_key(std::int64_t row, std::int64_t column, int width);

/// A point of the unit disk, from the unit square. [Shirley97]: Peter Shirley and Kenneth Chiu, "A Low
/// Distortion Map Between Disk and Square", Journal of Graphics Tools 2(3), 1997.
Eigen::Vector2d on_unit_disk(const Eigen::Vector2d& on_square);

/// Where on a light the shadow ray of a subpixel ends, see ShadowRays: all `side`^2 subpixels of a pixel
/// cover the light evenly, in an order of the pixel's own, so that penumbras have no bands.
Eigen::Vector2d light_sample(std::uint64_t key, int subpixel, int side);

/// `side`^2 such places that cover a light evenly, moved by `shift`, in [0, 1)^2, of the distance between
/// two.
std::vector<Eigen::Vector2d> light_samples(const Eigen::Vector2d& shift, int side);

}  // namespace mica::host
