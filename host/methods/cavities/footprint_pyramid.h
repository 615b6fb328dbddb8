#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace mica::host {

/// Averages of some numbers of a map over squares of 4, 8, ... texels, a mip map of which footprints of any
/// shape are interpolated. @tparam kChannels numbers a texel, of type Number.
template <int kChannels, typename Number = float>
class FootprintPyramid {
 public:
  using Square = Eigen::Array<Number, kChannels, 1>;
  static constexpr int kFirstSide = 4;  ///< texels a side of the finest squares

  struct Level {
    int width = 0, height = 0;  ///< squares a period
    std::vector<Square> squares;

    /// Square (i, j); any integers, wrapped.
    const Square& square(long i, long j) const {
      return squares[static_cast<std::size_t>(wrapped(j, height) * width + wrapped(i, width))];
    }
    Square& square(long i, long j) {
      return squares[static_cast<std::size_t>(wrapped(j, height) * width + wrapped(i, width))];
    }
  };

  /// All levels, of zeros; of a map of this size in texels.
  FootprintPyramid(int width, int height) : width_(width), height_(height) {
    int across = (width + kFirstSide - 1) / kFirstSide, up = (height + kFirstSide - 1) / kFirstSide;
    for (;; across = halved(across), up = halved(up)) {
      levels_.push_back(
          {across, up, std::vector<Square>(static_cast<std::size_t>(across) * up, Square::Zero())});
      if (across == 1 && up == 1) return;
    }
  }

  std::vector<Level>& levels() { return levels_; }
  const std::vector<Level>& levels() const { return levels_; }

  /// Fills all levels but the finest from the one below.
  void average_up() {
    for (std::size_t n = 1; n < levels_.size(); ++n)
      for (int j = 0; j < levels_[n].height; ++j)
        for (int i = 0; i < levels_[n].width; ++i)
          levels_[n].square(i, j) = of_four(levels_[n - 1], 2 * i, 2 * j);
  }

  /// What `value` says of the squares, under a Gaussian footprint in texels: interpolated between squares and
  /// between levels, and averaged over several places along the footprint's major axis where it is long. No
  /// finer than `finest_sigma`.
  template <typename Value>
  double average(const Eigen::Vector2d& mean, const Eigen::Matrix2d& cov, const Value& value) const {
    const double half_difference = 0.5 * (cov(0, 0) - cov(1, 1)), middle = 0.5 * (cov(0, 0) + cov(1, 1)),
                 root = std::hypot(half_difference, cov(0, 1));
    const double major = std::sqrt(middle + root), minor = std::sqrt(std::max(middle - root, 0.0));
    const double angle = 0.5 * std::atan2(cov(0, 1), half_difference);
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    // Places 1.7 standard deviations of the squares apart, unless they would be too many.
    const double ratio = major / std::max(minor, finest_sigma);
    const int places =
        ratio < 1.3 ? 1 : static_cast<int>(std::min(std::ceil(3 * ratio), static_cast<double>(kMaxPlaces)));
    const double sigma = std::max({places == 1 ? major : 3 * major / kMaxPlaces, minor, finest_sigma});
    const double spread = std::sqrt(std::max(major * major - sigma * sigma, 0.0));
    const double level = std::min(std::log2(sigma / finest_sigma), static_cast<double>(levels_.size() - 1));
    const auto lower = static_cast<std::size_t>(level);
    const std::size_t upper = std::min(lower + 1, levels_.size() - 1);
    const double share = level - static_cast<double>(lower);
    double sum = 0, weights = 0;
    for (int n = 0; n < places; ++n) {
      const double z = places == 1 ? 0 : kReach * ((2.0 * n + 1) / places - 1);
      const Eigen::Vector2d place = mean + z * spread * along;
      const double weight = std::exp(-0.5 * z * z);
      sum += (weight * (1 - share)) * interpolated(levels_[lower], place, value);
      if (share > 0) sum += (weight * share) * interpolated(levels_[upper], place, value);
      weights += weight;
    }
    return sum / weights;
  }

  /// Bilinear interpolation of squares with side B has the variance B^2 / 4 along an axis: B = 2 sigma.
  static constexpr double finest_sigma = 0.5 * kFirstSide;

  std::size_t bytes() const {
    std::size_t bytes = 0;
    for (const Level& level : levels_) bytes += level.squares.size() * sizeof(Square);
    return bytes;
  }

 private:
  static constexpr int kMaxPlaces = 16;
  static constexpr double kReach = 2.5;  // standard deviations to which the places along a footprint reach

  static int halved(int size) { return std::max((size + 1) / 2, 1); }
  static long wrapped(long index, long period) {
    if (0 <= index && index < period) return index;
    const long remainder = index % period;
    return remainder < 0 ? remainder + period : remainder;
  }

  /// Mean of (i, j) and its three neighbours; an odd last square counts twice.
  static Square of_four(const Level& level, int i, int j) {
    const int right = std::min(i + 1, level.width - 1), up = std::min(j + 1, level.height - 1);
    return (level.square(i, j) + level.square(right, j) + level.square(i, up) + level.square(right, up)) / 4;
  }

  template <typename Value>
  double interpolated(const Level& level, const Eigen::Vector2d& place, const Value& value) const {
    const double x = place.x() / width_ * level.width - 0.5, y = place.y() / height_ * level.height - 0.5;
    const double floor_x = std::floor(x), floor_y = std::floor(y), f = x - floor_x, g = y - floor_y;
    const auto i = static_cast<long>(floor_x), j = static_cast<long>(floor_y);
    return (1 - g) * ((1 - f) * value(level.square(i, j)) + f * value(level.square(i + 1, j))) +
           g * ((1 - f) * value(level.square(i, j + 1)) + f * value(level.square(i + 1, j + 1)));
  }

  int width_, height_;  // texels
  std::vector<Level> levels_;
};

}  // namespace mica::host
