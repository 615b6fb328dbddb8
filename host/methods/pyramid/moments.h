#pragma once

#include <Eigen/Core>

namespace mica::host {

using Matrix2x4d = Eigen::Matrix<double, 2, 4>;

/// Sums over a part of the map in (x, y, s, t): position in texels and normal on the disk. Sums of parts add
/// up.
struct Moments {
  double weight = 0;                                 ///< texels^2
  Eigen::Vector4d first = Eigen::Vector4d::Zero();   ///< of the four coordinates
  Eigen::Matrix4d second = Eigen::Matrix4d::Zero();  ///< of their products

  void add(const Moments& other) {
    weight += other.weight;
    first += other.first;
    second += other.second;
  }
  /// A part with this mean and covariance.
  void add(double part_weight, const Eigen::Vector4d& mean, const Eigen::Matrix4d& covariance) {
    add_weighted(part_weight, mean, part_weight * covariance);
  }
  /// The same, of a covariance times the weight.
  void add_weighted(double part_weight, const Eigen::Vector4d& mean,
                    const Eigen::Matrix4d& weighted_covariance) {
    const Eigen::Vector4d weighted_mean = part_weight * mean;
    weight += part_weight;
    first += weighted_mean;
    for (int column = 0; column < 4; ++column)
      second.col(column) += weighted_covariance.col(column) + mean[column] * weighted_mean;
  }

  Eigen::Vector4d mean() const { return first / weight; }
  /// Rounding may leave it a little short of positive semidefinite.
  Eigen::Matrix4d covariance() const { return second / weight - mean() * mean().transpose(); }
};

/// The part of a block whose normals lie in one cell of the disk.
struct CellMoments {
  int cell = 0;
  Moments moments;
};

}  // namespace mica::host
