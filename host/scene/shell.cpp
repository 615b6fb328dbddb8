#include "host/scene/shell.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "mica/error.h"

namespace mica::host {
namespace {

// [Raup66]'s parameters; lengths in units of the last whorl's distance from the axis.
constexpr double kGrowth = 0.69314718055994530942 / (2 * kPi);  ///< a radian: whorls double a turn
constexpr double kTubeRadius = 0.82;
constexpr double kTranslation =
    1.35;  ///< how far the last whorl's centre lies down the axis from the apex of the cone

/// Angle over which the tube tapers at the apex: two turns leave no visible pit behind its end.
constexpr double kApexAngle = 4 * kPi;

// The lip, in units of the tube's radius, and how far back along the spiral it reaches.
constexpr double kLipFlare = 0.1, kLipThickness = 0.08;
constexpr double kFlareAngle = 1.2, kInnerAngle = 1.4 * kPi;

// Pose, radians: the aperture's turn about the axis, the axis' lean towards -y, the turn of it all about the
// vertical.
constexpr float kSpin = -0.09f, kLean = 0.79f, kAzimuth = -0.26f;

constexpr int kShellStepsAround = 224, kStepsATurn = 192, kStepsAnEnd = 48;

/// The self-similar surface: theta along the spiral (0 at the aperture, negative before), c the share of the
/// tube's radius, phi around it.
namespace tube {

double scale(double theta) {
  return std::exp(kGrowth * theta);
}
// Clockwise from above: most snails are dextral.
Eigen::Vector3d radial(double theta) {
  return {std::cos(theta), -std::sin(theta), 0};
}
Eigen::Vector3d forward(double theta) {
  return {-std::sin(theta), -std::cos(theta), 0};
}
/// From the tube's centre line outwards; unit.
Eigen::Vector3d spoke(double theta, double phi) {
  return std::cos(phi) * radial(theta) + std::sin(phi) * Eigen::Vector3d::UnitZ();
}

Eigen::Vector3d position(double theta, double c, double phi) {
  return scale(theta) *
         (radial(theta) - kTranslation * Eigen::Vector3d::UnitZ() + c * kTubeRadius * spoke(theta, phi));
}
Eigen::Vector3d d_theta(double theta, double c, double phi) {
  return kGrowth * position(theta, c, phi) +
         scale(theta) * (1 + c * kTubeRadius * std::cos(phi)) * forward(theta);
}
Eigen::Vector3d d_c(double theta, double phi) {
  return scale(theta) * kTubeRadius * spoke(theta, phi);
}
/// Direction in which phi falls; unit, and so defined even where the circle has no radius.
Eigen::Vector3d around(double theta, double phi) {
  return std::sin(phi) * radial(theta) - std::cos(phi) * Eigen::Vector3d::UnitZ();
}
/// Length of the circle c = 1.
double circumference(double theta) {
  return 2 * kPi * kTubeRadius * scale(theta);
}

}  // namespace tube

/// A point of the curve (theta, c) that the tube follows, and the direction in which it goes on, of any
/// length.
struct ProfilePoint {
  double theta, c;
  double dtheta, dc;
};

/// Apex, outer wall, rim of the lip, inner wall and its rounded end, smoothly joined: the surface is closed.
class Profile {
 public:
  explicit Profile(double turns)
      : start_(-2 * kPi * turns), rounding_(kTubeRadius / tube::d_theta(0, 1, 0).norm()) {
    add(steps(kApexAngle) / 2, [&](double x) { return apex(x); });
    add(steps(-start_), [&](double x) { return outer_wall(x); });
    add(2 * kStepsAnEnd, [&](double x) { return rim(x); });
    add(steps(kInnerAngle), [&](double x) { return inner_wall(x); });
    add(kStepsAnEnd, [&](double x) { return inner_end(x); });
    points_.push_back(inner_end(1));
  }
  const std::vector<ProfilePoint>& points() const { return points_; }

 private:
  static int steps(double angle) { return static_cast<int>(std::ceil(angle / (2 * kPi) * kStepsATurn)); }

  template <class Section>
  void add(int count, const Section& section) {
    for (int i = 0; i < count; ++i) points_.push_back(section(static_cast<double>(i) / count));
  }

  ProfilePoint apex(double x) const {
    const double sin = std::sin(kPi / 2 * x), cos = std::cos(kPi / 2 * x);
    return {start_ - kApexAngle * cos, sin, kApexAngle * sin, cos};
  }
  ProfilePoint outer_wall(double x) const { return wall(start_ * (1 - x)); }
  ProfilePoint rim(double x) const {
    const double sin = std::sin(kPi * x), cos = std::cos(kPi * x), half = kLipThickness / 2;
    return {rounding_ * half * sin, 1 + kLipFlare - half + half * cos, rounding_ * cos, -sin};
  }
  ProfilePoint inner_wall(double x) const {
    const ProfilePoint outer = wall(-kInnerAngle * x);
    return {outer.theta, outer.c - kLipThickness, -outer.dtheta, -outer.dc};
  }
  ProfilePoint inner_end(double x) const {
    const double sin = std::sin(kPi / 2 * x), cos = std::cos(kPi / 2 * x), c = 1 - kLipThickness;
    return {-kInnerAngle - rounding_ * sin, c * cos, -rounding_ * cos, -c * sin};
  }
  /// The outer wall, which flares towards the lip as a smoothstep.
  static ProfilePoint wall(double theta) {
    const double x = std::max(0.0, 1 + theta / kFlareAngle);
    return {theta, 1 + kLipFlare * x * x * (3 - 2 * x), 1, kLipFlare * 6 * x * (1 - x) / kFlareAngle};
  }

  double start_, rounding_;  ///< rounding_: angle as long on the outer side as the tube's radius
  std::vector<ProfilePoint> points_;
};

void add_ring(const ProfilePoint& at, double u, TriangleMesh* mesh) {
  for (int j = 0; j <= kShellStepsAround; ++j) {
    const double v = static_cast<double>(j) / kShellStepsAround;
    const double phi = kPi - 2 * kPi * v;  // the seam faces the axis
    const Eigen::Vector3d along =
        at.dtheta * tube::d_theta(at.theta, at.c, phi) + at.dc * tube::d_c(at.theta, phi);
    mesh->positions.push_back(tube::position(at.theta, at.c, phi).cast<float>());
    mesh->normals.push_back(along.cross(tube::around(at.theta, phi)).normalized().cast<float>());
    mesh->tangents.push_back(along.normalized().cast<float>());
    mesh->uvs.emplace_back(u, v);
  }
}

/// Triangles between a ring and the next; those that vanish where a ring is a point are left out.
void join_rings(std::uint32_t first, bool from_point, bool to_point, TriangleMesh* mesh) {
  for (std::uint32_t j = 0; j < kShellStepsAround; ++j) {
    const std::uint32_t a = first + j, b = a + kShellStepsAround + 1;
    if (!to_point) mesh->triangles.push_back({a, b, b + 1});
    if (!from_point) mesh->triangles.push_back({a, b + 1, a + 1});
  }
}

TriangleMesh sweep(const std::vector<ProfilePoint>& profile) {
  TriangleMesh mesh;
  double u = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const ProfilePoint& at = profile[i];
    add_ring(at, u, &mesh);
    if (i + 1 == profile.size()) break;
    const ProfilePoint& next = profile[i + 1];
    u += (tube::position(next.theta, next.c, 0) - tube::position(at.theta, at.c, 0)).norm() /
         tube::circumference((at.theta + next.theta) / 2);
    join_rings(static_cast<std::uint32_t>(i * (kShellStepsAround + 1)), i == 0, i + 2 == profile.size(),
               &mesh);
  }
  return mesh;
}

/// Leans the axis as a snail carries it, and sets the bounding box on the ground.
void place(const ShellShape& shell, TriangleMesh* mesh) {
  const Eigen::Matrix3f rotation = (Eigen::AngleAxisf(kAzimuth, Eigen::Vector3f::UnitZ()) *
                                    Eigen::AngleAxisf(kLean, Eigen::Vector3f::UnitX()) *
                                    Eigen::AngleAxisf(kSpin, Eigen::Vector3f::UnitZ()))
                                       .toRotationMatrix();
  Eigen::AlignedBox3f box;
  for (Eigen::Vector3f& position : mesh->positions) box.extend(position = rotation * position);
  for (Eigen::Vector3f& normal : mesh->normals) normal = rotation * normal;
  for (Eigen::Vector3f& tangent : mesh->tangents) tangent = rotation * tangent;

  const Eigen::Vector3f foot(box.center().x(), box.center().y(), box.min().z());
  const float scale = static_cast<float>(shell.size) / box.sizes().z();
  for (Eigen::Vector3f& position : mesh->positions)
    position = shell.center.cast<float>() + scale * (position - foot);
}

}  // namespace

TriangleMesh make_shell(const ShellShape& shell) {
  if (!(shell.center.allFinite() && std::isfinite(shell.size) && shell.size > 0))
    throw UsageError("shell: center must be finite and size positive");
  if (!(shell.turns >= 1 && shell.turns <= 12)) throw UsageError("shell: turns must lie between 1 and 12");
  TriangleMesh mesh = sweep(Profile(shell.turns).points());
  place(shell, &mesh);
  return mesh;
}

}  // namespace mica::host
