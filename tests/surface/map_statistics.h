#pragma once

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "host/surface/disk.h"
#include "host/surface/synthesis.h"

/// What the tests of synthesis measure on square maps, resolution^2 texels, row v near 0 first.
namespace mica::host {

using Slopes = std::vector<Eigen::Vector2d>;

inline Slopes slopes_of(const std::vector<Eigen::Vector2d>& normals) {
  Slopes slopes;
  for (const Eigen::Vector2d& s : normals) slopes.push_back(slope_from_disk(s));
  return slopes;
}

inline double mean_square(const Slopes& slopes) {
  double sum = 0;
  for (const Eigen::Vector2d& slope : slopes) sum += slope.squaredNorm();
  return sum / static_cast<double>(slopes.size());
}

/// Mean squared change of the slope from a column to the next, by column; the last is around the seam.
inline std::vector<double> changes_along_u(const Slopes& slopes, int size) {
  std::vector<double> changes(static_cast<std::size_t>(size), 0.0);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i)
      changes[i] += (slopes[j * size + i] - slopes[j * size + (i + 1) % size]).squaredNorm() / size;
  return changes;
}

inline Slopes transposed(const Slopes& slopes, int size) {
  Slopes result(slopes.size());
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) result[i * size + j] = slopes[j * size + i];
  return result;
}

/// Standard deviations between the change across the seam and that between inner columns; large when the map
/// does not repeat.
inline double seam_score(const Slopes& slopes, int size) {
  const std::vector<double> changes = changes_along_u(slopes, size);
  const double count = size - 1, mean = std::accumulate(changes.begin(), changes.end() - 1, 0.0) / count;
  double variance = 0;
  for (int i = 0; i < size - 1; ++i) variance += std::pow(changes[i] - mean, 2) / count;
  return std::abs(changes.back() - mean) / std::sqrt(variance);
}

/// Both seams look like the inside. Of some hundred columns, the farthest is about 3 standard deviations off.
inline void expect_no_seam(const Slopes& slopes, int size) {
  EXPECT_LT(seam_score(slopes, size), 4) << "at u = 0";
  EXPECT_LT(seam_score(transposed(slopes, size), size), 4) << "at v = 0";
}

/// Expects the same bits on 1, 2 and 7 threads.
inline void expect_same_on_any_threads(const std::function<std::vector<Eigen::Vector2d>()>& normals) {
  const auto with = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return normals();
  };
  const std::vector<Eigen::Vector2d> alone = with(1);
  EXPECT_EQ(alone, with(2));
  EXPECT_EQ(alone, with(7));
}

/// Autocorrelation of one component of the slopes at an offset in texels, wrapped.
inline double autocorrelation(const Slopes& slopes, int size, int component, int along_u, int along_v) {
  double sum = 0, squares = 0;
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      const double here = slopes[j * size + i][component];
      sum += here * slopes[(j + along_v) % size * size + (i + along_u) % size][component];
      squares += here * here;
    }
  }
  return sum / squares;
}

}  // namespace mica::host
