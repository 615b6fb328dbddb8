// `beckmanns` against brute force: points of the surface under a footprint mirror the light. What hides view
// and light is the footprint's own slopes, as [Che18] has it; or the surface's heights, really displaced.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "host/base/random.h"
#include "host/methods/evaluator.h"
#include "host/methods/patch_brdf.h"
#include "host/methods/registry.h"
#include "host/surface/interpolate.h"
#include "host/surface/texel_footprint.h"

namespace mica::host::brute_force_patch_test {
namespace {

constexpr int kSize = 128;  // texels, the period
constexpr double kRoughness = 0.03;

/// A periodic sum of sine waves, lengths in texels.
class Heights {
 public:
  explicit Heights(double rms_slope) {
    for (int n = 0; waves_.size() < 40; ++n) {
      const Eigen::Vector2d periods(std::round(14 * random_unit(1, 0, n) - 7),
                                    std::round(14 * random_unit(1, 1, n) - 7));
      if (periods.norm() < 2 || periods.norm() > 7) continue;  // 18 to 64 texels long
      waves_.push_back({2 * M_PI / kSize * periods, 0, 2 * M_PI * random_unit(1, 2, n)});
    }
    for (Wave& wave : waves_)  // each has the same share of the squared slope
      wave.height = rms_slope * std::sqrt(2.0 / static_cast<double>(waves_.size())) / wave.k.norm();
    for (int n = 0; n < kSize * kSize; ++n) top_ = std::max(top_, at({n % kSize, n / kSize}));
  }

  double at(const Eigen::Vector2d& x) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += wave.height * std::sin(wave.k.dot(x) + wave.phase);
    return sum;
  }
  Eigen::Vector2d slope(const Eigen::Vector2d& x) const {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Wave& wave : waves_) sum += wave.height * std::cos(wave.k.dot(x) + wave.phase) * wave.k;
    return sum;
  }
  /// Whether a ray from the surface leaves it for good.
  bool leaves(const Eigen::Vector2d& x, const Eigen::Vector3d& direction) const {
    if (direction.z() <= 0) return false;
    const double start = at(x), across = direction.head<2>().norm();
    const double step = 0.5 / std::max(across, 1e-3);  // half a texel, of waves of 18
    for (double t = step; start + t * direction.z() < top_; t += step)
      if (at(x + t * direction.head<2>()) > start + t * direction.z()) return false;
    return true;
  }

 private:
  struct Wave {
    Eigen::Vector2d k;
    double height, phase;
  };
  std::vector<Wave> waves_;
  double top_ = -INFINITY;
};

Eigen::Vector2d disk_of(const Eigen::Vector2d& slope) {
  return -slope / std::sqrt(1 + slope.squaredNorm());
}

Surface normal_map(const Heights& heights) {
  std::vector<Eigen::Vector2d> normals;
  for (int n = 0; n < kSize * kSize; ++n)
    normals.push_back(disk_of(heights.slope({n % kSize + 0.5, n / kSize + 0.5})));
  return {kSize, kSize, Interpolation::bilinear, std::move(normals)};
}

/// Broad lights: the furnace, and two lobes from aside.
constexpr int kLights = 3;
using Seen = Eigen::Array<double, kLights, 1>;
Seen radiances(const Eigen::Vector3d& from) {
  const auto lobe = [&](const Eigen::Vector3d& axis) {
    return std::exp(6 * (from.dot(axis.normalized()) - 1));
  };
  return {1, lobe({0.8, 0.1, 1}), lobe({-0.4, -0.7, 0.5})};
}

/// The n-th of points that fill the unit interval evenly together with those of the other streams, moved by a
/// patch's number. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
double even_unit(int stream, int patch, int n) {
  constexpr std::array<double, 4> steps = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                                           0.5385972572236101};
  const double place = random_unit(7, stream, patch) + steps[stream] * n;
  return place - std::floor(place);
}

Eigen::Vector2d gaussian_pair(int stream, int patch, int n) {
  const double radius = std::sqrt(-2 * std::log1p(-even_unit(stream, patch, n)));
  const double turn = 2 * M_PI * even_unit(stream + 1, patch, n);
  return radius * Eigen::Vector2d(std::cos(turn), std::sin(turn));
}

/// A point of the surface, whose normal, that of the map, the roughness blurs.
struct Point {
  Eigen::Vector2d place;
  Eigen::Vector3d normal;

  double projected(const Eigen::Vector3d& direction) const { return direction.dot(normal) / normal.z(); }
};

std::vector<Point> points_under(const Surface& surface, const Eigen::Vector2d& middle, double sigma,
                                int patch) {
  constexpr int count = 6000;
  std::vector<Point> points;
  for (int n = 0; n < count; ++n) {
    const Eigen::Vector2d place = middle + sigma * gaussian_pair(0, patch, n);
    const Eigen::Vector2d s = normal_at(surface, place) + kRoughness * gaussian_pair(2, patch, n);
    if (s.squaredNorm() < 1)
      points.push_back({place, Eigen::Vector3d(s.x(), s.y(), std::sqrt(1 - s.squaredNorm()))});
  }
  return points;
}

/// Of points that face a direction, the share that they show it: their mean's projected area over the sum of
/// theirs. [Che18] Eq. 11
double own_masking(const std::vector<Point>& points, const Eigen::Vector3d& direction) {
  double all = 0, facing = 0;
  for (std::size_t n = 0; n < points.size(); n += 6) {
    const double area = points[n].projected(direction);
    all += area, facing += std::max(area, 0.0);
  }
  return facing > 0 ? std::max(all, 0.0) / facing : 0;
}

/// Radiance to the view, by the area that it sees of the points. @param displaced hidden by the heights.
Seen by_brute_force(const Heights& heights, const std::vector<Point>& points, const Eigen::Vector3d& view,
                    bool displaced) {
  std::vector<Eigen::Array<double, kLights + 1, 1>> terms(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t n) {
    terms[n].setZero();
    const Point& point = points[n];
    const double area = point.projected(view);
    if (area <= 0 || (displaced && !heights.leaves(point.place, view))) return;
    const Eigen::Vector3d light = 2 * view.dot(point.normal) * point.normal - view;
    terms[n](kLights) = area;
    if (light.z() <= 0) return;
    const double share =
        displaced ? (heights.leaves(point.place, light) ? 1.0 : 0.0) : own_masking(points, light);
    terms[n].head<kLights>() = area * share * radiances(light);
  });
  Eigen::Array<double, kLights + 1, 1> sum = Eigen::Array<double, kLights + 1, 1>::Zero();
  for (const auto& term : terms) sum += term;
  return sum.head<kLights>() / sum(kLights);
}

/// The same by the BRDF: mirror images of the view in normals on a grid of the disk, finer than the
/// roughness.
Seen by_brdf(PatchBrdf* brdf, const ViewQuery& view) {
  constexpr int steps = 120;
  std::vector<BrdfQuery> queries;
  std::vector<double> areas;
  for (int n = 0; n < steps * steps; ++n) {
    const Eigen::Vector2d s((2.0 * (n % steps) + 1) / steps - 1, (2.0 * (n / steps) + 1) / steps - 1);
    if (s.squaredNorm() > 0.98) continue;
    const Eigen::Vector3d h(s.x(), s.y(), std::sqrt(1 - s.squaredNorm()));
    const double cosine = h.dot(view.view);
    const Eigen::Vector3d light = 2 * cosine * h - view.view;
    if (cosine <= 0 || light.z() <= 0) continue;
    queries.push_back({view.footprint, view.view, light, view.roughness});
    areas.push_back(4.0 / (steps * steps) / h.z() * 4 * cosine);  // d i = 4 <o, h> d h
  }
  const std::vector<BrdfValue> values = brdf->evaluate(queries);
  Seen sum = Seen::Zero();
  for (std::size_t n = 0; n < values.size(); ++n)
    sum += values[n].single * areas[n] * radiances(queries[n].light);
  return sum;
}

/// By how much the BRDF of patches anywhere on the map is above brute force, in sum, for each light.
Seen excess(double sigma, double degrees, bool displaced) {
  static Device device(0);
  static const Heights heights(0.5);
  static const Surface surface = normal_map(heights);
  static const auto brdf = make_patch_brdf("beckmanns", device, surface, {});
  constexpr int patches = 8;
  const double polar = degrees * M_PI / 180;
  const Eigen::Vector3d view(std::sin(polar) * 0.8, std::sin(polar) * 0.6, std::cos(polar));
  Seen found = Seen::Zero(), expected = Seen::Zero();
  for (int n = 0; n < patches; ++n) {
    const Eigen::Vector2d middle(kSize * random_unit(9, 0, n), kSize * random_unit(9, 1, n));
    found +=
        by_brdf(brdf.get(), {make_footprint(surface, middle / kSize, sigma, sigma, 0), view, kRoughness});
    expected += by_brute_force(heights, points_under(surface, middle, sigma, n), view, displaced);
  }
  const Seen result = found / expected - 1;
  std::printf("sigma %g, %g degrees: %+.4f %+.4f %+.4f\n", sigma, degrees, result(0), result(1), result(2));
  return result;
}

TEST(BruteForcePatch, SendsAsMuchLightAsItsBrdf) {
  for (const double sigma : {0.7, 3.0, 20.0})
    for (const double degrees : {0.0, 30.0, 50.0})
      EXPECT_LT(excess(sigma, degrees, false).abs().maxCoeff(), 0.01)
          << sigma << ", " << degrees << " degrees";
}

/// Footprints as wide as the heights' waves: what hides smaller ones lies beside them.
TEST(BruteForcePatch, SendsAsMuchLightAsADisplacedOne) {
  for (const double degrees : {0.0, 30.0, 50.0})
    EXPECT_LT(excess(20, degrees, true).abs().maxCoeff(), 0.03) << degrees << " degrees";
}

}  // namespace
}  // namespace mica::host::brute_force_patch_test
