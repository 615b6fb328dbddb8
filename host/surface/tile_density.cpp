#include "host/surface/tile_density.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"

namespace mica::host {
namespace {

constexpr float kReach = 4;         // roughnesses that a lobe is seen from
constexpr float kThinnest = 0.01f;  // roughnesses: of a triangle whose area is told
constexpr float kWholeEdge = 1;     // roughnesses: of a triangle over which a lobe is told by three places

using Triangle = std::array<Eigen::Vector2f, 3>;

float length_of_edge(const Triangle& triangle, int n) {
  return (triangle[(n + 1) % 3] - triangle[n]).norm();
}

float cross(const Eigen::Vector2f& x, const Eigen::Vector2f& y) {
  return x.x() * y.y() - x.y() * y.x();
}

float share_below(float x) {
  return 0.5f * std::erfc(-x * static_cast<float>(std::sqrt(0.5)));
}

/// Of a lobe about 0 whose roughness is 1 and which is 1 high, the mean over a triangle, which is cut in
/// halves until it is narrow beside the lobe or its corners are far away.
/// @param looked_at counts triangles and their parts.
float mean_of_lobe(const Triangle& triangle, int* looked_at) {
  ++*looked_at;
  const auto& [a, b, c] = triangle;
  const Eigen::Array2f low = a.array().min(b.array()).min(c.array()),
                       high = a.array().max(b.array()).max(c.array());
  if ((low > kReach).any() || (high < -kReach).any()) return 0;
  const std::array<float, 3> lengths = {length_of_edge(triangle, 0), length_of_edge(triangle, 1),
                                        length_of_edge(triangle, 2)};
  const auto longest = static_cast<int>(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
  if (lengths[longest] <= kWholeEdge) {
    const auto middle = [&](int n) {
      return std::exp(-0.125f * (triangle[n] + triangle[(n + 1) % 3]).squaredNorm());
    };
    return (middle(0) + middle(1) + middle(2)) / 3;  // exact for quadrics
  }
  const float twice_area = cross(b - a, c - a);
  if (std::abs(twice_area) > kThinnest * lengths[longest]) {
    std::array<float, 3> inside{};  // distances of 0 from the edges
    for (int n = 0; n < 3; ++n)
      inside[n] = std::copysign(1.0f, twice_area) * cross(triangle[n], triangle[(n + 1) % 3]) / lengths[n];
    if (*std::min_element(inside.begin(), inside.end()) < -kReach) return 0;
    const auto farthest = static_cast<int>(std::max_element(inside.begin(), inside.end()) - inside.begin());
    const int one = (farthest + 1) % 3, other = (farthest + 2) % 3;
    // What lies beyond two edges at once lies behind their corner where that is acute.
    const bool is_corner_far = farthest != longest && triangle[other].squaredNorm() > kReach * kReach;
    if (inside[farthest] > kReach && (std::max(inside[one], inside[other]) > kReach || is_corner_far))
      return 4 * static_cast<float>(kPi) / std::abs(twice_area) *
             std::max(share_below(inside[one]) + share_below(inside[other]) - 1, 0.0f);
  }
  const Eigen::Vector2f &first = triangle[longest], &second = triangle[(longest + 1) % 3],
                        &apex = triangle[(longest + 2) % 3], middle = 0.5f * (first + second);
  return 0.5f *
         (mean_of_lobe({apex, first, middle}, looked_at) + mean_of_lobe({apex, middle, second}, looked_at));
}

}  // namespace

TileDensity::TileDensity(int side, const PairGrid& normals, Interpolation interpolation, int margin,
                         double sigma, double roughness)
    : flat_(interpolation == Interpolation::nearest), roughness_(static_cast<float>(roughness)) {
  const auto at = [&](int i, int j) -> Eigen::Vector2f {
    const std::complex<float>& normal = normals[static_cast<std::size_t>(j) * side + i];
    return {normal.real(), normal.imag()};
  };
  double sum = 0;
  for (int j = margin; j + margin < side; ++j)
    for (int i = margin; i + margin < side; ++i) {
      const double x = i + 0.5 - 0.5 * side, y = j + 0.5 - 0.5 * side;
      const double weight = std::exp(-0.5 * (x * x + y * y) / (sigma * sigma));
      const int next = flat_ ? 0 : 1;
      quads_.push_back(
          {at(i, j), at(i + next, j), at(i, j + next), at(i + next, j + next), static_cast<float>(weight)});
      sums_.push_back(sum += weight);
    }
}

bool TileDensity::reaches(const Quad& quad, const Eigen::Vector2f& half_vector) const {
  const float reach = kReach * roughness_;
  for (const int axis : {0, 1}) {
    const float h = half_vector[axis], a = quad.corner[axis], b = quad.right[axis], c = quad.up[axis],
                d = quad.far[axis];
    if (std::min(std::min(a, b), std::min(c, d)) > h + reach) return false;
    if (std::max(std::max(a, b), std::max(c, d)) < h - reach) return false;
  }
  return true;
}

double TileDensity::at(const Eigen::Vector2f& half_vector, int* looked_at) const {
  const auto seen = [&](const Eigen::Vector2f& normal) -> Eigen::Vector2f {
    return (normal - half_vector) / roughness_;
  };
  double sum = 0;
  for (const Quad& quad : quads_) {
    if (!reaches(quad, half_vector)) continue;
    if (flat_) {
      ++*looked_at;
      sum += quad.weight * std::exp(-0.5f * seen(quad.corner).squaredNorm());
    } else {
      // Its two triangles, split from (i + 1, j) to (i, j + 1).
      const Eigen::Vector2f right = seen(quad.right), up = seen(quad.up);
      sum += 0.5f * quad.weight *
             (mean_of_lobe({seen(quad.corner), right, up}, looked_at) +
              mean_of_lobe({seen(quad.far), up, right}, looked_at));
    }
  }
  return sum / (sums_.back() * 2 * kPi * roughness_ * roughness_);
}

Eigen::Vector2f TileDensity::draw(std::uint64_t seed, std::uint64_t number) const {
  const auto random = [&](std::uint64_t stream) {
    return static_cast<float>(random_unit(seed, stream, number));
  };
  const auto found = std::lower_bound(sums_.begin(), sums_.end(), random(0) * sums_.back());
  const Quad& quad = quads_[std::min<std::size_t>(found - sums_.begin(), quads_.size() - 1)];
  const float x = random(1), y = random(2);
  const Eigen::Vector2f normal =
      flat_ ? quad.corner
      : x + y < 1
          ? Eigen::Vector2f(quad.corner + x * (quad.right - quad.corner) + y * (quad.up - quad.corner))
          : Eigen::Vector2f(quad.far + (1 - x) * (quad.up - quad.far) + (1 - y) * (quad.right - quad.far));
  const float distance = roughness_ * std::sqrt(-2 * std::log1p(-random(3))),  // [Box and Muller 1958]
      angle = 2 * static_cast<float>(kPi) * random(4);
  return normal + distance * Eigen::Vector2f(std::cos(angle), std::sin(angle));
}

}  // namespace mica::host
