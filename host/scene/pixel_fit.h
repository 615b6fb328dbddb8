#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "host/scene/pixel_filter.h"
#include "host/scene/viewer.h"

namespace mica::host {

/// A half vector that turns less over a footprint, in standard deviations of the lobe, is taken as constant.
constexpr double kLeastTurn = 0.005;

/// What a pixel's fit needs of a point that a ray met.
struct Probe {
  static constexpr std::uint64_t kNothing = ~std::uint64_t{0};
  struct Lamp {
    bool is_above = false;  ///< as SeenLamp
    double visible = 0;     ///< as SeenLamp
    Eigen::Vector2d half_vector{0, 0};
    double roughness = 0;
    Color weight = Color::Zero();  ///< radiance per unit of D, of what is visible
  };
  std::uint64_t surface = kNothing;  ///< the same number on a shape's part
  std::uint32_t material = 0;
  bool faces_eye = false;
  Eigen::Vector2d uv{0, 0};
  Eigen::Matrix2d duv = Eigen::Matrix2d::Zero();
  Eigen::Vector3d normal{0, 0, 0};
  Color radiance = Color::Zero();
  std::vector<Lamp> lamps;
};
Probe probe_of(const SeenPoint& point);

/// c + g x + x' q x / 2 about a pixel's centre.
struct Quadratic {
  double value = 0;
  Eigen::Vector2d slope{0, 0};
  Eigen::Matrix2d turn = Eigen::Matrix2d::Zero();

  Eigen::Vector2d slope_at(const Eigen::Vector2d& x) const { return slope + turn * x; }
  /// Mean over a Gaussian of covariance `cov` about x.
  double mean(const Eigen::Vector2d& x, const Eigen::Matrix2d& cov) const {
    return value + slope.dot(x) + 0.5 * x.dot(turn * x) + 0.5 * (turn * cov).trace();
  }
};

/// How far one Gaussian may be from the place and the half vector that it stands for, in standard deviations
/// of the lobe, in the mean square: of the normals that the map shows there.
struct FitLimits {
  double residual = 0.1;
  int most_parts = 16;  ///< of a pixel and lamp
};

/// A pixel whose filter lies on one surface, by a least-squares fit of second order to thirteen rays: those
/// at its centre and its corners, and at the centres of its eight neighbours. Of uv and the half vectors the
/// first order goes into the queries; the second one, times the normals' change, says how far these are from
/// the truth, and splits them where that is too far.
class PixelFit {
 public:
  static constexpr std::size_t kRays = 13;
  /// Where the rays go, in pixels from the centre; the first one is the centre.
  static const std::array<Eigen::Vector2d, kRays>& offsets();

  /// @param probes on one surface, facing the eye, or all on none.
  explicit PixelFit(std::array<const Probe*, kRays> probes);

  /// Mean over the filter of what needs no P-NDF.
  Color radiance(const FilterSum& filter) const;
  Footprint footprint(const FilterSum& filter) const;

  /// Whether any of the rays sees the lamp above the horizon.
  bool sees(std::size_t lamp) const;

  /// How far the share of a lamp that is visible is from the fit's second order, root mean square.
  double penumbra_residual(std::size_t lamp) const;

  /// Queries for a lamp that is above the horizon in all of the pixel, or false where they would not do.
  /// @param normal_change E[(dn/du)' dn/du] of the map, per uv^2.
  bool ask(std::size_t lamp, const FilterSum& filter, const Eigen::Matrix2d& normal_change,
           const FitLimits& limits, std::vector<GlintQuery>* queries) const;

 private:
  struct Gaussian {
    Eigen::Vector2d mean;
    Eigen::Matrix2d cov;
    double weight;
  };
  struct LampFit {
    Quadratic s, t, red, green, blue;
    double roughness, residual2;  ///< of s and t, in the mean square
  };
  LampFit fit_lamp(std::size_t lamp) const;
  Eigen::Matrix2d second_order(const LampFit& lamp, const Eigen::Matrix2d& normal_change,
                               const Eigen::Matrix2d& cov) const;
  Eigen::Vector2d best_shift(const Eigen::Matrix2d& axes, const Eigen::Matrix2d& root,
                             const Eigen::Vector2d& log_weight_slope) const;
  bool query_of(const Gaussian& part, const LampFit& lamp, GlintQuery* query) const;

  std::array<const Probe*, kRays> probes_;
  Quadratic u_, v_;
  double uv_residual2_uu_ = 0, uv_residual2_uv_ = 0, uv_residual2_vv_ = 0;
};

}  // namespace mica::host
