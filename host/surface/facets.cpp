#include "host/surface/facets.h"

#include <array>
#include <cmath>

namespace mica::host {
namespace {

constexpr float kSame = 0.2f, kHalfStep = 0.51f, kMoreThanAStep = 1.5f;
constexpr int kPlaneTexels = 400;       // plateaus of slopes are seldom as wide
constexpr double kNearZero = 0.1;       // share of texels, of which
constexpr double kOneSideOfZero = 0.9;  // of what is half a step from 0: slopes that pass it lie on all sides

float distance(const std::complex<float>& a, const std::complex<float>& b) {
  return std::max(std::abs(a.real() - b.real()), std::abs(a.imag() - b.imag()));
}

bool is_near_zero(const std::complex<float>& value) {
  return distance(value, 0) <= kHalfStep;
}

/// Calls `visit(texel)` for those beside one.
template <typename Visit>
void beside(int side, int texel, const Visit& visit) {
  const int i = texel % side, j = texel / side;
  if (i > 0) visit(texel - 1);
  if (i + 1 < side) visit(texel + 1);
  if (j > 0) visit(texel - side);
  if (j + 1 < side) visit(texel + side);
}

/// Whether many texels are half a step from 0 and most of these on one side of it.
bool zero_is_no_number(const PairGrid& rounded) {
  std::array<int, 4> counts{};
  for (const std::complex<float>& value : rounded)
    if (is_near_zero(value)) ++counts[2 * (value.real() > 0) + (value.imag() > 0)];
  int all = 0, most = 0;
  for (const int count : counts) all += count, most = std::max(most, count);
  return most >= kOneSideOfZero * all && all >= kNearZero * static_cast<double>(rounded.size());
}

}  // namespace

Facets find_facets(int side, const PairGrid& rounded) {
  Facets facets;
  facets.of_texel.assign(rounded.size(), -1);
  const bool has_planes = zero_is_no_number(rounded);
  std::vector<int> open;
  for (int start = 0; start < side * side; ++start) {
    if (facets.of_texel[start] >= 0) continue;
    const auto facet = static_cast<int>(facets.is_plane.size());
    int texels = 0;
    std::array<int, 2> edges{}, steep_edges{};  // along u and v
    open.assign(1, start);
    facets.of_texel[start] = facet;
    while (!open.empty()) {
      const int texel = open.back();
      open.pop_back();
      ++texels;
      beside(side, texel, [&](int other) {
        const float apart = distance(rounded[texel], rounded[other]);
        const int axis = std::abs(other - texel) == 1 ? 0 : 1;
        if (apart > kSame) ++edges[axis], steep_edges[axis] += apart > kMoreThanAStep;
        if (apart > kSame || facets.of_texel[other] >= 0) return;
        facets.of_texel[other] = facet;
        open.push_back(other);
      });
    }
    const bool is_steep = 2 * steep_edges[0] > edges[0] && 2 * steep_edges[1] > edges[1];
    facets.is_cut_out.push_back(texels > 1 && is_steep);
    facets.is_plane.push_back(has_planes && texels >= kPlaneTexels && is_near_zero(rounded[start]));
  }
  return facets;
}

}  // namespace mica::host
