#include "host/scene/disk_cells.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "host/base/constants.h"

namespace mica::host {
namespace {

/// A sector of a ring, from -half to half about +x.
DiskCell sector(double inner, double outer, double half, double share) {
  const double area = half * (outer * outer - inner * inner);
  const double fourth = (std::pow(outer, 4) - std::pow(inner, 4)) / 4, bow = std::sin(2 * half) / 2;
  DiskCell cell;
  cell.mean = {2 * std::sin(half) * (std::pow(outer, 3) - std::pow(inner, 3)) / (3 * area), 0};
  cell.cov = Eigen::Vector2d(fourth * (half + bow) / area - cell.mean.x() * cell.mean.x(),
                             fourth * (half - bow) / area)
                 .asDiagonal();
  cell.share = share;
  return cell;
}

std::vector<DiskCell> make_cells(int rings) {
  const double share = 1.0 / cells_of(rings);
  std::vector<DiskCell> cells = {{{0, 0}, share / 4 * Eigen::Matrix2d::Identity(), share}};
  double inner2 = share;
  for (int ring = 1; ring <= rings; ++ring) {
    const int sectors = 6 * ring;
    const double outer2 = inner2 + sectors * share;
    const DiskCell first = sector(std::sqrt(inner2), std::sqrt(outer2), kPi / sectors, share);
    for (int n = 0; n < sectors; ++n) {
      const Eigen::Matrix2d turn =
          Eigen::Rotation2Dd(2 * kPi * (n + 0.5 * (ring % 2)) / sectors).toRotationMatrix();
      cells.push_back({turn * first.mean, turn * first.cov * turn.transpose(), share});
    }
    inner2 = outer2;
  }
  return cells;
}

}  // namespace

const std::vector<DiskCell>& disk_cells(int rings) {
  static const auto all = [] {
    std::array<std::vector<DiskCell>, kMostRings + 1> made;
    for (int n = 0; n <= kMostRings; ++n) made[static_cast<std::size_t>(n)] = make_cells(n);
    return made;
  }();
  return all[static_cast<std::size_t>(rings)];
}

double error_of_cells(double radius_lobes, int rings) {
  // One Gaussian is 0.97% off where the disk is as wide as the lobe; what two of three numbers of rings have
  // in common there is their cells' size, 2.4 lobes.
  const double radius_of_1_percent = rings == 0 ? 1 : 2.4 * rings + 0.25, most = 0.45;
  const double error = 0.0097 * std::pow(radius_lobes / radius_of_1_percent, 4);
  return error / std::sqrt(1 + error * error / (most * most));  // so far off is a disk's one Gaussian
}

LampParts LampParts::of(int most, double tolerance) {
  LampParts parts;
  parts.tolerance = tolerance;
  while (parts.most_rings < kMostRings && cells_of(parts.most_rings + 1) <= most) ++parts.most_rings;
  return parts;
}

int LampParts::rings(double radius_lobes) const {
  int rings = 0;
  while (rings < most_rings && error_of_cells(radius_lobes, rings) > tolerance) ++rings;
  return rings;
}

}  // namespace mica::host
