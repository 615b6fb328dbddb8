#include "host/scene/light_samples.h"

#include "host/base/random.h"
#include "host/scene/wrap.h"

namespace mica::host {

std::uint64_t place_key(std::int64_t row, std::int64_t column, int width) {
  if (row >= 0 && column >= 0 && column < width)
    return static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(width) +
           static_cast<std::uint64_t>(column);
  return scramble_bits(static_cast<std::uint64_t>(row) * kGoldenBits + static_cast<std::uint64_t>(column));
}

Eigen::Vector2d light_sample(std::uint64_t key, int subpixel, int side) {
  const std::uint64_t hash = scramble_bits((key + 1) * kGoldenBits);
  const double step = 1.0 / side, unit = 1.0 / 4294967296.0;
  const Eigen::Vector2d shift(unit * static_cast<double>(hash >> 32),
                              unit * static_cast<double>(hash & 0xffffffffu));
  return wrap(step * Eigen::Vector2d(subpixel % side, subpixel / side) + shift);
}

std::vector<Eigen::Vector2d> light_samples(const Eigen::Vector2d& shift, int side) {
  std::vector<Eigen::Vector2d> samples;
  for (int n = 0; n < side * side; ++n)
    samples.push_back((Eigen::Vector2d(n % side, n / side) + shift) / side);
  return samples;
}

}  // namespace mica::host
