#include "host/scene/light_samples.h"

#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/scene/wrap.h"

namespace mica::host {

std::uint64_t place_key(std::int64_t row, std::int64_t column, int width) {
  if (row >= 0 && column >= 0 && column < width)
    return static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(width) +
           static_cast<std::uint64_t>(column);
  return scramble_bits(static_cast<std::uint64_t>(row) * kGoldenBits + static_cast<std::uint64_t>(column));
}

Eigen::Vector2d on_unit_disk(const Eigen::Vector2d& on_square) {
  constexpr double quarter = kPi / 4;
  const double x = 2 * on_square.x() - 1, y = 2 * on_square.y() - 1;
  if (x == 0 && y == 0) return {0, 0};
  const bool wide = std::abs(x) > std::abs(y);
  const double radius = wide ? x : y, angle = wide ? quarter * y / x : 2 * quarter - quarter * x / y;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

Eigen::Vector2d light_sample(std::uint64_t key, int subpixel, int side) {
  const std::uint64_t hash = scramble_bits((key + 1) * kGoldenBits);
  const double step = 1.0 / side, unit = 1.0 / 4294967296.0;
  const Eigen::Vector2d shift(unit * static_cast<double>(hash >> 32),
                              unit * static_cast<double>(hash & 0xffffffffu));
  return on_unit_disk(wrap(step * Eigen::Vector2d(subpixel % side, subpixel / side) + shift));
}

std::vector<Eigen::Vector2d> light_samples(const Eigen::Vector2d& shift, int side) {
  std::vector<Eigen::Vector2d> samples;
  for (int n = 0; n < side * side; ++n)
    samples.push_back(on_unit_disk((Eigen::Vector2d(n % side, n / side) + shift) / side));
  return samples;
}

}  // namespace mica::host
