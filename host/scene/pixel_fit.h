#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/scene/pixel_filter.h"
#include "host/scene/second_order.h"
#include "host/scene/viewer.h"

namespace mica::host {

/// A half vector that turns less over a footprint, in standard deviations of the lobe, is taken as constant.
constexpr double kLeastTurn = 0.005;

/// Where the cosine between normal and eye changes more over a footprint, of itself, nothing is linear any
/// more, and half vectors are taken as constant: towards rims.
constexpr double kMostForeshortening = 0.1;

/// What a pixel's fit needs of a point that a ray met.
struct Probe {
  static constexpr std::uint64_t kNothing = ~std::uint64_t{0};
  struct Lamp {
    std::uint32_t light = 0;  ///< as SeenLamp
    bool is_above = false;    ///< as SeenLamp
    double visible = 0;       ///< as SeenLamp
    Eigen::Vector2d half_vector{0, 0};
    double roughness = 0;
    std::optional<Eigen::Matrix2d> lobe_cov;  ///< as SeenLamp
    Color weight = Color::Zero();             ///< radiance per unit of D, of what is visible
    Color smooth = Color::Zero();             ///< radiance that needs no P-NDF, likewise
    double weight_unshadowed = 0;             ///< as SeenLamp
    double missed = 0;                        ///< as SeenLamp
  };
  std::uint64_t surface = kNothing;  ///< the same number on a shape's part
  std::uint32_t material = 0;
  bool faces_eye = false;
  Eigen::Vector2d uv{0, 0};
  Eigen::Matrix2d duv = Eigen::Matrix2d::Zero();
  Eigen::Vector3d normal{0, 0, 0};
  Color radiance = Color::Zero();  ///< of what needs no P-NDF, of all lamps
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

/// Where a pixel's fit looks, in pixels from the centre, which is the first of all places, and how it makes a
/// quadratic of what it finds: by least squares with weights of a Gaussian of half a pixel.
class FitStencil {
 public:
  static constexpr std::size_t kMost = 13;
  using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;

  /// A pixel's centre and corners, and the centres of its eight neighbours.
  static const FitStencil& centers_and_corners();
  /// A pixel's centre and those of its eight neighbours, row by row.
  static const FitStencil& centers();

  std::size_t size() const { return offsets_.size(); }
  const std::vector<Eigen::Vector2d>& offsets() const { return offsets_; }
  Values zeros() const { return Values::Zero(static_cast<Eigen::Index>(size())); }
  Quadratic fit(const Values& values, Values* residual = nullptr) const;
  /// The weighted mean of a product.
  double mean_product(const Values& a, const Values& b) const;

 private:
  using Basis = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMost, 6>;
  explicit FitStencil(std::vector<Eigen::Vector2d> offsets);

  std::vector<Eigen::Vector2d> offsets_;
  Values weights_;
  Basis basis_;
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMost> solve_;
};

/// How far the Gaussians that stand for a pixel may be from it.
struct FitLimits {
  double relative_l2 = 0.01;  ///< of what a lamp's glints show, over pixels alike
  int most_parts = 16;        ///< of a pixel and lamp, for each Gaussian of its filter along an axis
};

/// What a pixel's fit knows, by place of its stencil.
using ProbesOfFit = std::array<const Probe*, FitStencil::kMost>;
using UvSteps = std::array<Eigen::Vector2d, FitStencil::kMost>;

/// The change of uv from the centre to each place. The map repeats: of all that a place may mean the one
/// nearest to where the centre's uv lead.
UvSteps repeating_steps(const FitStencil& stencil, const ProbesOfFit& probes);

/// A pixel whose filter lies on one surface, by a least-squares fit of second order to what its stencil
/// finds. The first order goes into the queries: D as an integral over uv takes the map's normals as they
/// are, so that all it can miss is how the filter lies on uv and how half vectors turn with them. The second
/// order says how much that is, and splits the filter where it is too much.
class PixelFit {
 public:
  /// @param stencil has to outlive it. @param probes on one surface, facing the eye, or all on none.
  PixelFit(const FitStencil& stencil, const ProbesOfFit& probes, const UvSteps& steps);

  /// Mean over the filter of what needs no P-NDF. @param without lamps that do not count.
  Color radiance(const FilterSum& filter, const std::vector<std::uint32_t>& without = {}) const;
  Footprint footprint(const FilterSum& filter) const;

  /// Whether any of the rays sees the lamp above the horizon.
  bool sees(std::size_t lamp) const;

  /// How far the share of a lamp that is visible is from the fit's second order, root mean square.
  double penumbra_residual(std::size_t lamp) const;

  /// Queries for a lamp that is above the horizon in all of the pixel, or false where they would not do.
  bool ask(std::size_t lamp, const FilterSum& filter, const FitLimits& limits,
           std::vector<GlintQuery>* queries) const;

 private:
  using Values = FitStencil::Values;
  struct Gaussian {
    Eigen::Vector2d mean;
    Eigen::Matrix2d cov;
    double weight;
  };
  struct LampFit {
    Quadratic s, t, red, green, blue, unshadowed;
    double roughness;
    std::optional<Eigen::Matrix2d> lobe_cov;
    Values s_residual, t_residual, unshadowed_residual;

    Eigen::Matrix2d lobe() const {
      return lobe_cov.value_or(roughness * roughness * Eigen::Matrix2d::Identity());
    }
  };
  /// A part of the filter to the first order, in the coordinates in which it is round.
  struct Frame {
    Eigen::Matrix2d root, axes;  ///< of pixels and of uv
    Eigen::Matrix2d turn;        ///< dh/du
    SecondOrder bend;
  };
  LampFit fit_lamp(std::size_t lamp) const;
  std::optional<Frame> frame_of(const Gaussian& part, const LampFit& lamp) const;
  double third_order(const LampFit& lamp, const Frame& frame) const;
  bool query_of(const Gaussian& part, const Frame& frame, const LampFit& lamp, GlintQuery* query) const;

  const FitStencil& stencil_;
  ProbesOfFit probes_;
  Quadratic u_, v_;
  Values u_residual_, v_residual_;
};

}  // namespace mica::host
