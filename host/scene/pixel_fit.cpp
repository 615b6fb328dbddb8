#include "host/scene/pixel_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/base/normal_equations.h"
#include "host/base/symmetric_matrix.h"
#include "host/scene/footprint.h"
#include "host/scene/wrap.h"

namespace mica::host {
namespace {

using Values = FitStencil::Values;

constexpr double kMaxCondition = 50;  // of uv over the pixel; footprints of more than 100 are shortened
constexpr double kWholePeriod = 0.5;  // sigma in periods from which on place says nothing of the normal

}  // namespace

Probe probe_of(const SeenPoint& point) {
  Probe probe;
  probe.radiance = point.radiance;
  if (!point.hit) return probe;
  probe.surface = (std::uint64_t{point.hit->shape} << 32) | point.hit->part;
  probe.material = point.material;
  probe.faces_eye = point.faces_eye;
  probe.uv = point.uv, probe.duv = point.duv;
  probe.normal = point.frame.z;
  for (const SeenLamp& lamp : point.lamps)
    probe.lamps.push_back({lamp.is_above, lamp.visible, lamp.half_vector, lamp.seen.roughness,
                           lamp.visible > 0
                               ? Color(lamp.seen.glint_weight.cwiseProduct(lamp.incident.irradiance))
                               : Color(Color::Zero())});
  return probe;
}

FitStencil::FitStencil(std::vector<Eigen::Vector2d> offsets)
    : offsets_(std::move(offsets)), weights_(zeros()), basis_(static_cast<Eigen::Index>(size()), 6) {
  for (std::size_t n = 0; n < size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    const double x = offsets_[n].x(), y = offsets_[n].y();
    weights_[row] = std::exp(-2 * offsets_[n].squaredNorm());
    basis_.row(row) << 1, x, y, x * x / 2, x * y, y * y / 2;
  }
  weights_ /= weights_.sum();
  const Eigen::MatrixXd basis = basis_, weighted = basis.transpose() * weights_.asDiagonal();
  solve_ = solve_normal_equations(weighted.lazyProduct(basis), weighted);
}

const FitStencil& FitStencil::centers_and_corners() {
  static const FitStencil stencil({{0, 0},
                                   {-.5, -.5},
                                   {.5, -.5},
                                   {-.5, .5},
                                   {.5, .5},
                                   {-1, -1},
                                   {0, -1},
                                   {1, -1},
                                   {-1, 0},
                                   {1, 0},
                                   {-1, 1},
                                   {0, 1},
                                   {1, 1}});
  return stencil;
}

const FitStencil& FitStencil::centers() {
  static const FitStencil stencil(
      {{0, 0}, {-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}});
  return stencil;
}

Quadratic FitStencil::fit(const Values& values, Values* residual) const {
  const Eigen::Matrix<double, 6, 1> c = solve_.lazyProduct(values);
  if (residual) *residual = values - basis_.lazyProduct(c);
  Quadratic result;
  result.value = c[0];
  result.slope = {c[1], c[2]};
  result.turn << c[3], c[4], c[4], c[5];
  return result;
}

double FitStencil::mean_product(const Values& a, const Values& b) const {
  return (weights_.array() * a.array() * b.array()).sum();
}

UvSteps repeating_steps(const FitStencil& stencil, const ProbesOfFit& probes) {
  UvSteps steps;
  const Probe& middle = *probes[0];
  for (std::size_t n = 0; n < stencil.size(); ++n) {
    const Eigen::Vector2d expected = middle.duv * stencil.offsets()[n];
    steps[n] = probes[n]->uv - middle.uv;
    steps[n] -= (steps[n] - expected).array().round().matrix();
  }
  return steps;
}

PixelFit::PixelFit(const FitStencil& stencil, const ProbesOfFit& probes, const UvSteps& steps)
    : stencil_(stencil), probes_(probes) {
  Values u = stencil.zeros(), v = u, u_residual, v_residual;
  for (std::size_t n = 0; n < stencil.size(); ++n)
    u[static_cast<Eigen::Index>(n)] = steps[n].x(), v[static_cast<Eigen::Index>(n)] = steps[n].y();
  u_ = stencil.fit(u, &u_residual), v_ = stencil.fit(v, &v_residual);
  uv_residual2_uu_ = stencil.mean_product(u_residual, u_residual);
  uv_residual2_uv_ = stencil.mean_product(u_residual, v_residual);
  uv_residual2_vv_ = stencil.mean_product(v_residual, v_residual);
}

Color PixelFit::radiance(const FilterSum& filter) const {
  Color mean = Color::Zero();
  const Eigen::Matrix2d cov = filter.sigma_pixels * filter.sigma_pixels * Eigen::Matrix2d::Identity();
  for (int channel = 0; channel < 3; ++channel) {
    Values values = stencil_.zeros();
    for (std::size_t n = 0; n < stencil_.size(); ++n)
      values[static_cast<Eigen::Index>(n)] = probes_[n]->radiance[channel];
    const Quadratic fitted = stencil_.fit(values);
    double sum = 0;
    for (std::size_t i = 0; i < filter.weights.size(); ++i)
      for (std::size_t j = 0; j < filter.weights.size(); ++j)
        sum += filter.weights[i] * filter.weights[j] *
               fitted.mean({filter.offsets_pixels[i], filter.offsets_pixels[j]}, cov);
    mean[channel] = std::max(sum, 0.0);
  }
  return mean;
}

Footprint PixelFit::footprint(const FilterSum& filter) const {
  const double variance = filter.variance();
  const Eigen::Matrix2d cov = variance * Eigen::Matrix2d::Identity();
  Eigen::Matrix2d duv;
  duv << u_.slope.transpose(), v_.slope.transpose();
  const Eigen::Vector2d mean(u_.mean({0, 0}, cov), v_.mean({0, 0}, cov));
  return {wrap(probes_[0]->uv + mean), footprint_covariance(duv, std::sqrt(variance))};
}

bool PixelFit::sees(std::size_t lamp) const {
  return std::any_of(probes_.begin(), probes_.begin() + static_cast<std::ptrdiff_t>(stencil_.size()),
                     [&](const Probe* probe) { return probe->lamps[lamp].visible > 0; });
}

double PixelFit::penumbra_residual(std::size_t lamp) const {
  Values visible = stencil_.zeros(), residual;
  for (std::size_t n = 0; n < stencil_.size(); ++n)
    visible[static_cast<Eigen::Index>(n)] = probes_[n]->lamps[lamp].visible;
  stencil_.fit(visible, &residual);
  return std::sqrt(stencil_.mean_product(residual, residual));
}

PixelFit::LampFit PixelFit::fit_lamp(std::size_t lamp) const {
  Values s = stencil_.zeros(), t = s, red = s, green = s, blue = s, s_residual, t_residual;
  for (std::size_t n = 0; n < stencil_.size(); ++n) {
    const Probe::Lamp& seen = probes_[n]->lamps[lamp];
    const auto k = static_cast<Eigen::Index>(n);
    s[k] = seen.half_vector.x(), t[k] = seen.half_vector.y();
    red[k] = seen.weight.x(), green[k] = seen.weight.y(), blue[k] = seen.weight.z();
  }
  LampFit fitted;
  fitted.s = stencil_.fit(s, &s_residual), fitted.t = stencil_.fit(t, &t_residual);
  fitted.red = stencil_.fit(red), fitted.green = stencil_.fit(green), fitted.blue = stencil_.fit(blue);
  fitted.roughness = probes_[0]->lamps[lamp].roughness;
  fitted.residual2 =
      stencil_.mean_product(s_residual, s_residual) + stencil_.mean_product(t_residual, t_residual);
  return fitted;
}

/// E[|n(u) - h - H (u - c)|^2] over a Gaussian is half the trace of this: what the second order of place and
/// half vector adds, by direction in the coordinates in which the Gaussian is round.
Eigen::Matrix2d PixelFit::second_order(const LampFit& lamp, const Eigen::Matrix2d& normal_change,
                                       const Eigen::Matrix2d& cov) const {
  const Eigen::Matrix2d root = cholesky_factor(cov);
  const auto round = [&](const Quadratic& q) -> Eigen::Matrix2d { return root.transpose() * q.turn * root; };
  const Eigen::Matrix2d u = round(u_), v = round(v_), s = round(lamp.s), t = round(lamp.t);
  return s * s + t * t + normal_change(0, 0) * u * u + normal_change(1, 1) * v * v +
         normal_change(0, 1) * (u * v + v * u);
}

/// Where a footprint lies best, in the coordinates in which `part` is round. To the first order the weight is
/// exp(a y), and uv bend by q: the footprint is G(y) (1 + a y + y' q(y, y) y / 2 - div q y), which is no
/// Gaussian any more; of all that move it this one is nearest in the mean square over the plane, where
/// glints lie anywhere.
Eigen::Vector2d PixelFit::best_shift(const Eigen::Matrix2d& axes, const Eigen::Matrix2d& root,
                                     const Eigen::Vector2d& log_weight_slope) const {
  const Eigen::Matrix2d inverse = axes.inverse();
  const Eigen::Matrix2d u = root.transpose() * u_.turn * root, v = root.transpose() * v_.turn * root;
  const Eigen::Matrix2d bend[2] = {inverse(0, 0) * u + inverse(0, 1) * v,
                                   inverse(1, 0) * u + inverse(1, 1) * v};
  const Eigen::Vector2d divergence = bend[0].row(0).transpose() + bend[1].row(1).transpose();
  const Eigen::Vector2d laplacian(bend[0].trace(), bend[1].trace());
  return root.transpose() * log_weight_slope - 0.5 * divergence + 0.25 * laplacian;
}

bool PixelFit::query_of(const Gaussian& part, const LampFit& lamp, GlintQuery* query) const {
  constexpr double most_shift = 0.3;  // standard deviations: beyond it the first order is none
  const Eigen::Vector2d& mean = part.mean;
  const Eigen::Matrix2d root = cholesky_factor(part.cov);
  Eigen::Matrix2d duv, dh;
  duv << u_.slope_at(mean).transpose(), v_.slope_at(mean).transpose();
  dh << lamp.s.slope_at(mean).transpose(), lamp.t.slope_at(mean).transpose();
  const Eigen::Matrix2d axes = duv * root;
  const double determinant = std::abs(axes.determinant()), square = axes.squaredNorm();
  if (!(determinant * kMaxCondition > square)) return false;

  const Color weight(lamp.red.mean(mean, part.cov), lamp.green.mean(mean, part.cov),
                     lamp.blue.mean(mean, part.cov));
  if (!(weight.sum() > 0)) {  // where a penumbra ends
    query->weight.setZero();
    return true;
  }
  const Eigen::Vector2d weight_slope =
      lamp.red.slope_at(mean) + lamp.green.slope_at(mean) + lamp.blue.slope_at(mean);
  const Eigen::Vector2d shift = best_shift(axes, root, weight_slope / weight.sum());
  if (!(shift.norm() < most_shift)) return false;

  Query& asked = query->query;
  const Eigen::Matrix2d none = Eigen::Matrix2d::Zero(), turn = dh * duv.inverse();
  const Eigen::Vector2d uv = Eigen::Vector2d(u_.mean(mean, none), v_.mean(mean, none)) + axes * shift;
  asked.footprint = {wrap(probes_[0]->uv + uv), footprint_covariance(axes, 1)};
  // Of the second order of h(u) half its mean: glints see the square of the Gaussian.
  const auto half_vector = [&](const Quadratic& h, int row) {
    const Eigen::Matrix2d bend = h.turn - turn(row, 0) * u_.turn - turn(row, 1) * v_.turn;
    return h.mean(mean, none) + dh.row(row).dot(root * shift) + 0.25 * (bend * part.cov).trace();
  };
  asked.half_vector = {half_vector(lamp.s, 0), half_vector(lamp.t, 1)};
  if (!(asked.half_vector.squaredNorm() < 1)) return false;
  asked.roughness = lamp.roughness;
  asked.half_vector_turn.setZero(), asked.lobe_cov.reset();
  const Eigen::Matrix2d spread = dh * part.cov * dh.transpose();
  if (spread.trace() > kLeastTurn * kLeastTurn * lamp.roughness * lamp.roughness) {
    if (asked.footprint.cov_uv.trace() > kWholePeriod * kWholePeriod) {
      Eigen::Matrix2d lobe = lamp.roughness * lamp.roughness * Eigen::Matrix2d::Identity() + spread;
      lobe(1, 0) = lobe(0, 1);
      asked.lobe_cov = lobe;
    } else {
      asked.half_vector_turn = turn;
    }
  }
  query->weight = (part.weight * weight.cwiseMax(0)).cast<float>();
  return true;
}

bool PixelFit::ask(std::size_t lamp, const FilterSum& filter, const Eigen::Matrix2d& normal_change,
                   const FitLimits& limits, std::vector<GlintQuery>* queries) const {
  const LampFit fitted = fit_lamp(lamp);
  const double limit2 = std::pow(limits.residual * fitted.roughness, 2);
  const double third_order2 = fitted.residual2 + normal_change(0, 0) * uv_residual2_uu_ +
                              2 * normal_change(0, 1) * uv_residual2_uv_ +
                              normal_change(1, 1) * uv_residual2_vv_;
  if (!(third_order2 <= limit2)) return false;

  std::vector<Gaussian> parts;
  const Eigen::Matrix2d round = filter.sigma_pixels * filter.sigma_pixels * Eigen::Matrix2d::Identity();
  for (std::size_t j = 0; j < filter.weights.size(); ++j)
    for (std::size_t i = 0; i < filter.weights.size(); ++i)
      parts.push_back({{filter.offsets_pixels[i], filter.offsets_pixels[j]},
                       round,
                       filter.weights[i] * filter.weights[j]});
  std::vector<GlintQuery> asked;
  while (!parts.empty()) {
    if (parts.size() + asked.size() > static_cast<std::size_t>(limits.most_parts) * filter.weights.size())
      return false;
    const Gaussian part = parts.back();
    parts.pop_back();
    const Eigen::Matrix2d second = second_order(fitted, normal_change, part.cov);
    const double square = 0.5 * second.trace();
    if (square <= limit2) {
      GlintQuery query;
      query.light = static_cast<std::uint32_t>(lamp);
      if (!query_of(part, fitted, &query)) return false;
      asked.push_back(query);
      continue;
    }
    // Along the direction that bends most: along it alone its share falls with sigma^4.
    const PrincipalAxes axes = principal_axes(second);
    const auto& splits = gaussian_splits();
    const auto enough = std::find_if(splits.begin(), splits.end(), [&](const GaussianSplit& split) {
      return 0.5 * (axes.eigenvalues[0] + axes.eigenvalues[1] * std::pow(split.sigma, 4)) <= limit2;
    });
    const GaussianSplit& split = enough == splits.end() ? splits.back() : *enough;
    const Eigen::Matrix2d root = cholesky_factor(part.cov);
    const Eigen::Vector2d axis = root * axes.eigenvectors.col(1);
    const Eigen::Matrix2d cov = part.cov - (1 - split.sigma * split.sigma) * axis * axis.transpose();
    for (std::size_t n = 0; n < split.parts.weights.size(); ++n)
      parts.push_back(
          {part.mean + split.parts.offsets_pixels[n] * axis, cov, part.weight * split.parts.weights[n]});
  }
  queries->insert(queries->end(), asked.begin(), asked.end());
  return true;
}

}  // namespace mica::host
