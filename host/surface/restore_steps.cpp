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

constexpr int kLongestStride = 64;

/// A place of the grid and the eight around it.
struct Neighbourhood {
  std::size_t place, left, right, down, up, down_left, down_right, up_left, up_right;

  /// Second differences.
  float along_u(const float* x) const { return x[left] - 2 * x[place] + x[right]; }
  float along_v(const float* x) const { return x[down] - 2 * x[place] + x[up]; }
  float along_rise(const float* x) const { return x[down_left] - 2 * x[place] + x[up_right]; }
  float along_fall(const float* x) const { return x[up_left] - 2 * x[place] + x[down_right]; }

  /// All four, along u, v, and the diagonals up to the right and down to the right.
  std::array<float, 4> along_all(const float* x) const {
    return {along_u(x), along_v(x), along_rise(x), along_fall(x)};
  }
};

/// Calls `visit(neighbourhood)` for places of a grid, in parallel, wrapped.
/// @param stride to those around. @param margin that is left out along the edges.
template <typename Visit>
void everywhere(int width, int height, int stride, int margin, const Visit& visit) {
  const int rows_a_task = std::max(1, (1 << 16) / width);
  tbb::parallel_for(tbb::blocked_range<int>(margin, height - margin, static_cast<std::size_t>(rows_a_task)),
                    [&](const tbb::blocked_range<int>& rows) {
                      for (int j = rows.begin(); j < rows.end(); ++j) {
                        const auto row = [&](int k) {
                          return static_cast<std::size_t>(wrapped(k, height)) * width;
                        };
                        const std::size_t own = row(j), below = row(j - stride), above = row(j + stride);
                        const auto at = [&](std::size_t i, std::size_t l, std::size_t r) {
                          visit(Neighbourhood{own + i, own + l, own + r, below + i, above + i, below + l,
                                              below + r, above + l, above + r});
                        };
                        for (int i = margin; i < width - margin; ++i) {
                          if (i >= stride && i < width - stride)
                            at(i, i - stride, i + stride);
                          else
                            at(i, wrapped(i - stride, width), wrapped(i + stride, width));
                        }
                      }
                    });
}

/// @param rounded what the grid has to round to.
void smooth(int stride, int iterations, const std::vector<float>& rounded, RoundedGrid* grid) {
  constexpr float largest = 4 * 16;  // bound of the gradient's slope: a second difference's norm is 4
  std::vector<float>& found = grid->values;
  std::vector<float> ahead = found;
  std::array<std::vector<float>, 4> tensions;
  tensions.fill(std::vector<float>(found.size()));  // 0 where a difference would leave the grid
  double momentum = 1;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    everywhere(grid->width, grid->height, stride, stride, [&](const Neighbourhood& n) {
      const std::array<float, 4> seconds = n.along_all(ahead.data());
      for (std::size_t d = 0; d < seconds.size(); ++d) tensions[d][n.place] = seconds[d];
    });
    const double next = 0.5 * (1 + std::sqrt(1 + 4 * momentum * momentum));
    const auto carried = static_cast<float>((momentum - 1) / next);
    momentum = next;
    everywhere(grid->width, grid->height, stride, 0, [&](const Neighbourhood& n) {
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
    const int count = stride == 1 ? iterations : iterations / 3 + 1;
    smooth(stride, count, rounded_u.values, u);
    smooth(stride, count, rounded_v.values, v);
  }
}

}  // namespace mica::host
