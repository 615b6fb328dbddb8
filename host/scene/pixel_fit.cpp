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

/// The smaller variance of a lobe.
double narrowest(const Eigen::Matrix2d& lobe_cov) {
  return principal_axes_directly(lobe_cov).eigenvalues[0];
}

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
  for (const SeenLamp& lamp : point.lamps) {
    const auto lit = [&](const Color& by_unit) {
      return lamp.visible > 0 ? Color(by_unit.cwiseProduct(lamp.incident.irradiance)) : Color(Color::Zero());
    };
    probe.lamps.push_back({lamp.light, lamp.is_above, lamp.visible, lamp.half_vector, lamp.seen.roughness,
                           lamp.lobe_cov, lit(lamp.seen.glint_weight), lit(lamp.seen.smooth),
                           lamp.weight_unshadowed, lamp.missed});
  }
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
  Values u = stencil.zeros(), v = u;
  for (std::size_t n = 0; n < stencil.size(); ++n)
    u[static_cast<Eigen::Index>(n)] = steps[n].x(), v[static_cast<Eigen::Index>(n)] = steps[n].y();
  u_ = stencil.fit(u, &u_residual_), v_ = stencil.fit(v, &v_residual_);
}

Color PixelFit::radiance(const FilterSum& filter, const std::vector<std::uint32_t>& without) const {
  Color mean = Color::Zero();
  const Eigen::Matrix2d cov = filter.sigma_pixels * filter.sigma_pixels * Eigen::Matrix2d::Identity();
  for (int channel = 0; channel < 3; ++channel) {
    Values values = stencil_.zeros();
    for (std::size_t n = 0; n < stencil_.size(); ++n) {
      double& value = values[static_cast<Eigen::Index>(n)];
      value = probes_[n]->radiance[channel];
      for (const Probe::Lamp& lamp : probes_[n]->lamps)
        if (std::binary_search(without.begin(), without.end(), lamp.light)) value -= lamp.smooth[channel];
    }
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
  Values s = stencil_.zeros(), t = s, red = s, green = s, blue = s, unshadowed = s;
  for (std::size_t n = 0; n < stencil_.size(); ++n) {
    const Probe::Lamp& seen = probes_[n]->lamps[lamp];
    const auto k = static_cast<Eigen::Index>(n);
    s[k] = seen.half_vector.x(), t[k] = seen.half_vector.y();
    red[k] = seen.weight.x(), green[k] = seen.weight.y(), blue[k] = seen.weight.z();
    unshadowed[k] = seen.weight_unshadowed;
  }
  LampFit fitted;
  fitted.s = stencil_.fit(s, &fitted.s_residual), fitted.t = stencil_.fit(t, &fitted.t_residual);
  fitted.red = stencil_.fit(red), fitted.green = stencil_.fit(green), fitted.blue = stencil_.fit(blue);
  fitted.unshadowed = stencil_.fit(unshadowed, &fitted.unshadowed_residual);
  fitted.roughness = probes_[0]->lamps[lamp].roughness;
  fitted.lobe_cov = probes_[0]->lamps[lamp].lobe_cov;
  return fitted;
}

std::optional<PixelFit::Frame> PixelFit::frame_of(const Gaussian& part, const LampFit& lamp) const {
  Frame frame;
  frame.root = cholesky_factor(part.cov);
  Eigen::Matrix2d duv, dh;
  duv << u_.slope_at(part.mean).transpose(), v_.slope_at(part.mean).transpose();
  dh << lamp.s.slope_at(part.mean).transpose(), lamp.t.slope_at(part.mean).transpose();
  frame.axes = duv * frame.root;
  const double determinant = std::abs(frame.axes.determinant()), square = frame.axes.squaredNorm();
  if (!(determinant * kMaxCondition > square)) return std::nullopt;
  frame.turn = dh * duv.inverse();
  const auto round = [&](const Quadratic& q) -> Eigen::Matrix2d {
    return frame.root.transpose() * q.turn * frame.root;
  };
  const Eigen::Matrix2d inverse = frame.axes.inverse(), u = round(u_), v = round(v_);
  const Quadratic* const h[2] = {&lamp.s, &lamp.t};
  for (int row = 0; row < 2; ++row) {
    frame.bend.of_uv[row] = inverse(row, 0) * u + inverse(row, 1) * v;
    frame.bend.of_h[row] = round(*h[row]) - frame.turn(row, 0) * u - frame.turn(row, 1) * v;
  }
  const double weight = lamp.unshadowed.mean(part.mean, Eigen::Matrix2d::Zero());
  const Eigen::Vector2d slope = frame.root.transpose() * lamp.unshadowed.slope_at(part.mean) / weight;
  frame.bend.of_log_weight = round(lamp.unshadowed) / weight - slope * slope.transpose();
  return frame;
}

/// The square of the relative L2 by which Gaussians of all of the filter differ from it for what is not even
/// of second order: as places that are moved, and as half vectors.
double PixelFit::third_order(const LampFit& lamp, const Frame& frame) const {
  const Eigen::Matrix2d inverse = frame.axes.inverse(), &turn = frame.turn;
  const double weight = lamp.unshadowed.value;
  double square =
      stencil_.mean_product(lamp.unshadowed_residual, lamp.unshadowed_residual) / (weight * weight);
  Values misses[2];
  for (int row = 0; row < 2; ++row) {
    const Values moved = inverse(row, 0) * u_residual_ + inverse(row, 1) * v_residual_;
    const Values turned = (row == 0 ? lamp.s_residual : lamp.t_residual) - turn(row, 0) * u_residual_ -
                          turn(row, 1) * v_residual_;
    square += stencil_.mean_product(moved, moved);
    misses[row] = turned;
  }
  const Eigen::Matrix2d in_lobes = lamp.lobe().inverse();
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) square += 0.5 * in_lobes(i, j) * stencil_.mean_product(misses[i], misses[j]);
  return square;
}

bool PixelFit::query_of(const Gaussian& part, const Frame& frame, const LampFit& lamp,
                        GlintQuery* query) const {
  constexpr double most_shift = 0.3;  // standard deviations: beyond it the first order is none
  const Eigen::Vector2d& mean = part.mean;
  const Color weight(lamp.red.mean(mean, part.cov), lamp.green.mean(mean, part.cov),
                     lamp.blue.mean(mean, part.cov));
  if (!(weight.sum() > 0)) {  // where a penumbra ends
    query->weight.setZero();
    return true;
  }
  const Eigen::Vector2d weight_slope =
      lamp.red.slope_at(mean) + lamp.green.slope_at(mean) + lamp.blue.slope_at(mean);
  const Eigen::Vector2d shift = best_shift(frame.bend, frame.root.transpose() * weight_slope / weight.sum());
  if (!(shift.norm() < most_shift)) return false;

  Query& asked = query->query;
  const Eigen::Matrix2d none = Eigen::Matrix2d::Zero();
  const Eigen::Vector2d moved = frame.axes * shift;
  const Eigen::Vector2d uv = Eigen::Vector2d(u_.mean(mean, none), v_.mean(mean, none)) + moved;
  asked.footprint = {wrap(probes_[0]->uv + uv), footprint_covariance(frame.axes, 1)};
  // Of the second order of h(u) half its mean: glints see the square of the Gaussian.
  const auto half_vector = [&](const Quadratic& h, int row) {
    return h.mean(mean, none) + frame.turn.row(row).dot(moved) + 0.25 * frame.bend.of_h[row].trace();
  };
  asked.half_vector = {half_vector(lamp.s, 0), half_vector(lamp.t, 1)};
  if (!(asked.half_vector.squaredNorm() < 1)) return false;
  asked.roughness = lamp.roughness;
  asked.half_vector_turn.setZero(), asked.lobe_cov = lamp.lobe_cov;
  const Eigen::Matrix2d across = frame.turn * frame.axes, spread = across * across.transpose();
  if (spread.trace() > kLeastTurn * kLeastTurn * narrowest(lamp.lobe())) {
    if (asked.footprint.cov_uv.trace() > kWholePeriod * kWholePeriod) {
      Eigen::Matrix2d lobe = lamp.lobe() + spread;
      lobe(1, 0) = lobe(0, 1);
      asked.lobe_cov = lobe;
    } else {
      asked.half_vector_turn = frame.turn;
    }
  }
  query->weight = (part.weight * weight.cwiseMax(0)).cast<float>();
  return true;
}

bool PixelFit::ask(std::size_t lamp, const FilterSum& filter, const FitLimits& limits,
                   std::vector<GlintQuery>* queries) const {
  const LampFit fitted = fit_lamp(lamp);
  const std::optional<Frame> whole =
      frame_of({{0, 0}, filter.variance() * Eigen::Matrix2d::Identity(), 1}, fitted);
  if (!whole) return false;
  const double beyond = third_order(fitted, *whole), limit2 = std::pow(limits.relative_l2, 2) - beyond;
  if (!(limit2 >= 0)) return false;

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
    const std::optional<Frame> frame = frame_of(part, fitted);
    if (!frame) return false;
    const Eigen::Matrix2d missed = left_out(frame->bend, fitted.lobe());
    if (missed.trace() <= limit2) {
      GlintQuery query;
      query.light = probes_[0]->lamps[lamp].light;
      query.missed_by_lamp = static_cast<float>(probes_[0]->lamps[lamp].missed);
      query.missed_by_footprint = static_cast<float>(std::sqrt(missed.trace() + beyond));
      if (!query_of(part, *frame, fitted, &query)) return false;
      asked.push_back(query);
      continue;
    }
    // Along the direction that bends most, whose share falls with sigma^2 at least.
    const PrincipalAxes axes = principal_axes(missed);
    const auto& splits = gaussian_splits();
    const auto enough = std::find_if(splits.begin(), splits.end(), [&](const GaussianSplit& split) {
      return axes.eigenvalues[0] + axes.eigenvalues[1] * split.sigma * split.sigma <= limit2;
    });
    const GaussianSplit& split = enough == splits.end() ? splits.back() : *enough;
    const Eigen::Vector2d axis = frame->root * axes.eigenvectors.col(1);
    const Eigen::Matrix2d cov = part.cov - (1 - split.sigma * split.sigma) * axis * axis.transpose();
    for (std::size_t n = 0; n < split.parts.weights.size(); ++n)
      parts.push_back(
          {part.mean + split.parts.offsets_pixels[n] * axis, cov, part.weight * split.parts.weights[n]});
  }
  queries->insert(queries->end(), asked.begin(), asked.end());
  return true;
}

}  // namespace mica::host
