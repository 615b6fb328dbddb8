#include "host/surface/restore_steps.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "host/surface/features.h"

namespace mica::host {
namespace {

using synthesis::wrapped;

/// Second differences of a rounded ramp have the mean square 1/2: 6 times the variance of rounding, 1/12.
/// Texels that differ by more than that from a ramp are left alone, in between they give way by a part.
constexpr float kSmooth = 0.65f, kRough = 0.9f;
constexpr int kShareReach = 12;  // of the square over which they are averaged
constexpr int kLongestStride = 64;

/// A place of the grid and the eight around it.
struct Neighbourhood {
  std::size_t place, left, right, down, up, down_left, down_right, up_left, up_right;

  /// Second differences.
  float along_u(const float* x) const { return x[left] - 2 * x[place] + x[right]; }
  float along_v(const float* x) const { return x[down] - 2 * x[place] + x[up]; }
  float along_rise(const float* x) const { return x[down_left] - 2 * x[place] + x[up_right]; }
  float along_fall(const float* x) const { return x[up_left] - 2 * x[place] + x[down_right]; }

  /// All four, in the order of SmoothShares.
  std::array<float, 4> along_all(const float* x) const {
    return {along_u(x), along_v(x), along_rise(x), along_fall(x)};
  }
};

/// Calls `visit(neighbourhood)` for all places of a grid, in parallel. @param stride to those around.
template <typename Visit>
void everywhere(int width, int height, int stride, const Visit& visit) {
  const int rows_a_task = std::max(1, (1 << 16) / width);
  tbb::parallel_for(tbb::blocked_range<int>(0, height, static_cast<std::size_t>(rows_a_task)),
                    [&](const tbb::blocked_range<int>& rows) {
                      for (int j = rows.begin(); j < rows.end(); ++j) {
                        const auto row = [&](int k) {
                          return static_cast<std::size_t>(wrapped(k, height)) *
                                 static_cast<std::size_t>(width);
                        };
                        const std::size_t own = row(j), below = row(j - stride), above = row(j + stride);
                        const auto at = [&](int i, int before, int after) {
                          const auto x = static_cast<std::size_t>(i), l = static_cast<std::size_t>(before),
                                     r = static_cast<std::size_t>(after);
                          visit(Neighbourhood{own + x, own + l, own + r, below + x, above + x, below + l,
                                              below + r, above + l, above + r});
                        };
                        const int last = width - stride;
                        for (int i = 0; i < width; ++i) {
                          if (i >= stride && i < last)
                            at(i, i - stride, i + stride);
                          else
                            at(i, wrapped(i - stride, width), wrapped(i + stride, width));
                        }
                      }
                    });
}

/// Means over squares of 2 kShareReach + 1 numbers a side.
std::vector<float> averaged(int width, int height, const std::vector<float>& values) {
  const auto pass = [](int count, int lines, const std::vector<float>& in, const auto& place) {
    std::vector<float> out(in.size());
    tbb::parallel_for(0, lines, [&](int line) {
      const auto value = [&](int n) { return static_cast<double>(in[place(wrapped(n, count), line)]); };
      double sum = 0;
      for (int n = -kShareReach; n <= kShareReach; ++n) sum += value(n);
      for (int n = 0; n < count; ++n) {
        out[place(n, line)] = static_cast<float>(std::max(sum, 0.0) / (2 * kShareReach + 1));
        sum += value(n + kShareReach + 1) - value(n - kShareReach);
      }
    });
    return out;
  };
  const auto stride = static_cast<std::size_t>(width);
  const std::vector<float> rows = pass(width, height, values, [&](int n, int line) {
    return static_cast<std::size_t>(line) * stride + static_cast<std::size_t>(n);
  });
  return pass(height, width, rows, [&](int n, int line) {
    return static_cast<std::size_t>(n) * stride + static_cast<std::size_t>(line);
  });
}

}  // namespace

SmoothShares smooth_shares(const RoundedGrid& u, const RoundedGrid& v, int stride) {
  SmoothShares squares;
  for (std::vector<float>& of_direction : squares) of_direction.resize(u.values.size());
  everywhere(u.width, u.height, stride, [&](const Neighbourhood& n) {
    const std::array<float, 4> of_u = n.along_all(u.values.data()), of_v = n.along_all(v.values.data());
    for (std::size_t d = 0; d < squares.size(); ++d)
      squares[d][n.place] = 0.5f * (of_u[d] * of_u[d] + of_v[d] * of_v[d]);
  });
  SmoothShares shares;
  for (std::size_t d = 0; d < shares.size(); ++d) {
    shares[d] = averaged(u.width, u.height, squares[d]);
    for (float& share : shares[d]) share = std::clamp((kRough - share) / (kRough - kSmooth), 0.0f, 1.0f);
  }
  return shares;
}

namespace {

/// @param rounded what the grid has to round to.
void smooth(const SmoothShares& shares, int stride, int iterations, const std::vector<float>& rounded,
            RoundedGrid* grid) {
  float largest = 0;  // bound of the gradient's slope: a second difference's norm is 4
  for (const std::vector<float>& share : shares)
    largest += 16 * *std::max_element(share.begin(), share.end());
  if (!(largest > 0)) return;
  std::vector<float>& found = grid->values;
  std::vector<float> ahead = found;
  SmoothShares tensions = shares;
  double momentum = 1;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    everywhere(grid->width, grid->height, stride, [&](const Neighbourhood& n) {
      const std::array<float, 4> seconds = n.along_all(ahead.data());
      for (std::size_t d = 0; d < seconds.size(); ++d) tensions[d][n.place] = shares[d][n.place] * seconds[d];
    });
    const double next = 0.5 * (1 + std::sqrt(1 + 4 * momentum * momentum));
    const auto carried = static_cast<float>((momentum - 1) / next);
    momentum = next;
    everywhere(grid->width, grid->height, stride, [&](const Neighbourhood& n) {
      const float slope = n.along_u(tensions[0].data()) + n.along_v(tensions[1].data()) +
                          n.along_rise(tensions[2].data()) + n.along_fall(tensions[3].data());
      const float middle = rounded[n.place],
                  moved = std::clamp(ahead[n.place] - slope / largest, middle - 0.5f, middle + 0.5f);
      ahead[n.place] = moved + carried * (moved - found[n.place]);
      found[n.place] = moved;
    });
  }
}

}  // namespace

void restore_steps(int iterations, RoundedGrid* u, RoundedGrid* v) {
  const RoundedGrid rounded_u = *u, rounded_v = *v;
  for (int stride = kLongestStride; stride > 0; stride /= 2) {
    if (4 * stride > std::min(u->width, u->height)) continue;
    const SmoothShares shares = smooth_shares(rounded_u, rounded_v, stride);
    const int count = stride == 1 ? iterations : iterations / 3 + 1;
    smooth(shares, stride, count, rounded_u.values, u);
    smooth(shares, stride, count, rounded_v.values, v);
  }
}

}  // namespace mica::host
