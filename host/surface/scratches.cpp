#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/base/random.h"
#include "host/surface/features.h"
#include "host/surface/height_modes.h"
#include "host/surface/settings.h"
#include "host/surface/synthesis.h"

namespace mica::host {
namespace {

enum ScratchStream : std::uint64_t {
  scratch_u_stream,
  scratch_v_stream,
  scratch_length_stream,
  scratch_width_stream,
  scratch_depth_stream,
  scratch_angle_stream,
  scratch_bend_stream
};

constexpr double kResolvedWidth = 4;  // texels; narrower, and a slanting groove falls apart into dots

void check(const ScratchesSurface& scratches) {
  const auto check = [](const char* setting, double value, double low, double high) {
    synthesis::check_setting("scratches", setting, value, low, high);
  };
  synthesis::check_resolution("scratches", scratches.resolution);
  check("density", scratches.density, 0, 4);
  check("length in texels", scratches.length_texels, 2, scratches.resolution);
  check("width in texels", scratches.width_texels, 1, scratches.length_texels);
  check("depth in texels", scratches.depth_texels, 0, scratches.width_texels);
  check("variation", scratches.variation, 0, 0.9);
  check("direction in degrees", scratches.direction_degrees, -360, 360);
  check("spread in degrees", scratches.spread_degrees, 0, 90);
  check("bend", scratches.bend, 0, 0.2);
}

/// A height across the scratch, 0 where |x| = 1 and -1 at its deepest, with its derivative.
struct Profile {
  double height, slope;
};

Profile profile_at(ScratchProfile profile, double x) {
  if (profile == ScratchProfile::v) return {std::abs(x) - 1, x < 0 ? -1.0 : 1.0};
  // -(1 - x^2)^2 (1 - 3 x^2): the rim, at x^2 = 5/9, is 13% of the depth high.
  const double y = x * x;
  return {-(1 - y) * (1 - y) * (1 - 3 * y), -2 * x * (1 - y) * (9 * y - 5)};
}

}  // namespace

synthesis::Extent Scratch::extent() const {
  return {direction, half_length, std::min(bend, 0.0) - half_width, std::max(bend, 0.0) + half_width};
}

Eigen::Vector2d Scratch::slope(const Eigen::Vector2d& offset) const {
  const Eigen::Vector2d left(-direction.y(), direction.x());
  const double t = direction.dot(offset) / half_length;
  const double x = (left.dot(offset) - bend * (1 - t * t)) / half_width;
  if (std::abs(t) >= 1 || std::abs(x) >= 1) return {0, 0};
  const Profile across = profile_at(profile, x);
  const double share = 1 - t * t * t * t;  // share of the depth: less and less towards the ends
  const double across_slope = depth * share * across.slope / half_width;
  const double along_slope =
      (depth * -4 * t * t * t * across.height + across_slope * 2 * bend * t) / half_length;
  return along_slope * direction + across_slope * left;
}

std::vector<Scratch> place_scratches(const ScratchesSurface& scratches) {
  check(scratches);
  const double area = static_cast<double>(scratches.resolution) * scratches.resolution;
  const auto count = static_cast<std::uint64_t>(
      std::llround(scratches.density * area / (scratches.length_texels * scratches.width_texels)));
  std::vector<Scratch> placed;
  for (std::uint64_t n = 0; n < count; ++n) {
    const auto unit = [&](ScratchStream stream) { return random_unit(scratches.seed, stream, n); };
    const auto varied = [&](ScratchStream stream) {
      return 1 + scratches.variation * (2 * unit(stream) - 1);
    };
    const double degrees =
        scratches.direction_degrees + scratches.spread_degrees * (2 * unit(scratch_angle_stream) - 1);
    const double angle = degrees * kPi / 180;
    Scratch scratch;
    scratch.center_texels =
        scratches.resolution * Eigen::Vector2d(unit(scratch_u_stream), unit(scratch_v_stream));
    scratch.direction = {std::cos(angle), std::sin(angle)};
    scratch.half_length = scratches.length_texels / 2 * varied(scratch_length_stream);
    scratch.half_width = scratches.width_texels / 2 * varied(scratch_width_stream);
    scratch.depth = scratches.depth_texels * varied(scratch_depth_stream);
    scratch.bend = scratches.bend * 2 * scratch.half_length * (2 * unit(scratch_bend_stream) - 1);
    scratch.profile = scratches.profile;
    placed.push_back(scratch);
  }
  return placed;
}

std::vector<Eigen::Vector2d> synthesise_scratches(const ScratchesSurface& scratches, SurfaceReport& report) {
  const std::vector<Scratch> placed = place_scratches(scratches);
  report.notes.push_back(fmt::format("scratches: {} scratches on {} x {} texels", placed.size(),
                                     scratches.resolution, scratches.resolution));
  const double narrowest = scratches.width_texels * (1 - scratches.variation);
  if (narrowest < kResolvedWidth) {
    report.warnings.push_back(fmt::format(
        "scratches: widths from {} texels on are finer than the texels resolve; expected {} or more",
        narrowest, kResolvedWidth));
  }
  return synthesis::normals_of_features(scratches.resolution, placed);
}

}  // namespace mica::host
