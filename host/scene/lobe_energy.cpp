#include "host/scene/lobe_energy.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/microfacet/horizon.h"
#include "host/microfacet/low_discrepancy.h"
#include "host/microfacet/masking.h"
#include "host/scene/fresnel.h"

namespace mica::host {
namespace {

constexpr int kCosines = 32;  // steps of their square root: E changes most at grazing views
constexpr int kAzimuths = 8;  // of half a turn: lobes about g are alike on both halves
constexpr int kNormals = 2048;
constexpr double kGrazingCosine = 1e-3;
constexpr double kLeastAlbedo = 0.05;  // no light grows by more than twenty times

/// Normals of equal weight on the disk, of the lobe blurred by the roughness. Those beyond its rim are lost.
std::vector<Eigen::Vector3d> blurred_normals(const MaterialDescription& material, const SmoothLobe& lobe) {
  const SmoothLobe facets = material.glints ? lobe : lobe.narrowed(material.roughness_uv());
  std::vector<Eigen::Vector3d> normals;
  for (int n = 0; n < kNormals; ++n) {
    const Eigen::Vector2d slope = facets.slope(low_discrepancy_point(static_cast<std::uint32_t>(n), 0));
    // [Roberts 2018], the plastic number's sequence: independent of Sobol's.
    const double radius = std::sqrt(-2 * std::log1p(-std::fmod(0.5 + 0.7548776662466927 * n, 1.0))),
                 turn = 2 * kPi * std::fmod(0.5 + 0.5698402909980532 * n, 1.0);
    const Eigen::Vector2d s =
        slope / std::sqrt(1 + slope.squaredNorm()) +
        radius * material.roughness_uv().cwiseProduct(Eigen::Vector2d(std::cos(turn), std::sin(turn)));
    const double z2 = 1 - s.squaredNorm();
    if (z2 > 0) normals.emplace_back(s.x(), s.y(), std::sqrt(z2));
  }
  return normals;
}

std::size_t place_of(int row, int column) {
  return static_cast<std::size_t>(row) * kAzimuths + static_cast<std::size_t>(column);
}

}  // namespace

LobeEnergy::LobeEnergy(const MaterialDescription& material, const SmoothLobe& lobe)
    : normal_reflectance_(reflectance(material.specular, 1)), table_((kCosines + 1) * kAzimuths) {
  const std::vector<Eigen::Vector3d> normals = blurred_normals(material, lobe);
  const double masking_alpha = lobe.mean_alpha();
  for (int row = 0; row <= kCosines; ++row)
    for (int column = 0; column < kAzimuths; ++column) {
      const double root = static_cast<double>(row) / kCosines, azimuth = kPi * column / kAzimuths;
      const double cosine = std::max(root * root, kGrazingCosine), sine = std::sqrt(1 - cosine * cosine);
      const Eigen::Vector3d view(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine);
      double sum = 0;
      for (const Eigen::Vector3d& normal : normals) {
        const double facing = view.dot(normal);
        const Eigen::Vector3d light = 2 * facing * normal - view;
        if (facing <= 0 || light.z() < kMinCosine) continue;
        const double G = material.glints ? lobe.masking_shadowing(view, light)
                                         : smith_masking_shadowing(view.z(), light.z(), masking_alpha);
        sum += G * facing / normal.z();
      }
      table_[place_of(row, column)] = std::max(sum / (cosine * kNormals), kLeastAlbedo);
    }
}

double LobeEnergy::albedo(const Eigen::Vector3d& view) const {
  const double row = kCosines * std::sqrt(std::clamp(view.z(), 0.0, 1.0)),
               turn = std::atan2(view.y(), view.x()) / kPi, column = kAzimuths * (turn - std::floor(turn));
  const int i = std::min(static_cast<int>(row), kCosines - 1), j = static_cast<int>(column);
  const double f = row - i, g = column - j;
  const auto at = [&](int down, int right) { return table_[place_of(i + down, (j + right) % kAzimuths)]; };
  return (1 - f) * ((1 - g) * at(0, 0) + g * at(0, 1)) + f * ((1 - g) * at(1, 0) + g * at(1, 1));
}

}  // namespace mica::host
