#include "host/methods/map/turned_query.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "host/methods/map/map_query.h"
#include "host/methods/map/periods.h"

namespace mica::host {
namespace {

constexpr double kMaxTurn =
    2;  // of the half vector over the footprint's standard deviation: the disk's diameter
constexpr double kMaxTurnedSigmaTexels = 16384;

double largest_eigenvalue(const Eigen::Matrix2d& symmetric) {
  const double half_difference = 0.5 * (symmetric(0, 0) - symmetric(1, 1));
  return 0.5 * symmetric.trace() + std::hypot(half_difference, symmetric(0, 1));
}

}  // namespace

/// The query is a Gaussian of place u and normal m. Its m has the covariance M = S + H C H', and u given m
/// the mean c + K (m - h), K = C H' M^-1, and the covariance P = (C^-1 + H' S^-1 H)^-1. Of the map's waves P
/// lets some through, see the `without_needless_periods` of footprints; P may become as short as lets through
/// just those, and K matters along them only. With the new P and K it is again a query: C = P + K M K', S =
/// (M^-1 + K' P^-1 K)^-1, H = S K' P^-1.
Query without_needless_periods(const Query& query) {
  const Eigen::Matrix2d &cov = query.footprint.cov_uv, &turn = query.half_vector_turn;
  const Eigen::Matrix2d lobe = lobe_covariance(query);
  const Eigen::Matrix2d place = (cov.inverse() + turn.transpose() * lobe.inverse() * turn).inverse();
  const Eigen::Matrix2d waves = reduced_waves(0.5 * (place + place.transpose()));
  const Eigen::Matrix2d form = waves.transpose() * place * waves;
  Query result = query;
  if (form(1, 1) <= kUniformVariance) return result;
  const Eigen::Matrix2d normals = lobe + turn * cov * turn.transpose();
  if (form(0, 0) > kUniformVariance) {
    result.half_vector_turn.setZero();  // the footprint is wider than P, and sees all alike
    result.lobe_cov = normals;
    return result;
  }
  // In coordinates along the waves only the first one matters.
  Eigen::Matrix2d follow = waves.transpose() * cov * turn.transpose() * normals.inverse();
  follow.row(1).setZero();
  const Eigen::Matrix2d shorter = Eigen::Vector2d(form(0, 0), kUniformVariance).asDiagonal();
  const Eigen::Matrix2d to_plane = waves.inverse().array().round().matrix();
  result.footprint.cov_uv =
      to_plane.transpose() * (shorter + follow * normals * follow.transpose()) * to_plane;
  result.footprint.cov_uv(1, 0) = result.footprint.cov_uv(0, 1);
  const Eigen::Matrix2d pull = follow.transpose() * shorter.inverse();
  result.lobe_cov = (normals.inverse() + pull * follow).inverse();
  result.half_vector_turn = *result.lobe_cov * pull * waves.transpose();
  return result;
}

std::string lobe_problem(const Query& query, double least, double most) {
  const Eigen::Matrix2d lobe = lobe_covariance(query);
  if (!lobe.allFinite() || lobe(0, 1) != lobe(1, 0)) return "lobe is not finite and symmetric";
  if (!(lobe(0, 0) > 0 && lobe(1, 1) > 0)) return "lobe is not positive definite";
  const FootprintAxes axes = footprint_axes({Eigen::Vector2d::Zero(), lobe}, 1, 1);
  if (!(axes.sigma_minor_texels > 0)) return "lobe is not positive definite";
  if (axes.sigma_minor_texels >= least * (1 - 1e-9) && axes.sigma_major_texels <= most * (1 + 1e-9))
    return {};
  return fmt::format("lobe of {:.3g} x {:.3g} (standard deviations) is outside [{}, {}]",
                     axes.sigma_major_texels, axes.sigma_minor_texels, least, most);
}

std::string turn_problem(const Query& query) {
  const Eigen::Matrix2d& turn = query.half_vector_turn;
  if (!turn.allFinite()) return "turn of the half vector is not finite";
  if (turn.isZero(0)) return {};
  const double most = std::sqrt(largest_eigenvalue(turn * query.footprint.cov_uv * turn.transpose()));
  if (most <= kMaxTurn) return {};
  return fmt::format("half vector turns by {:.3g} over the footprint's standard deviation, more than {}",
                     most, kMaxTurn);
}

std::string first_order_problem(const Query& query, int map_width, int map_height) {
  std::string problem = lobe_problem(query, kMinRoughness, kMaxRoughness);
  if (problem.empty()) problem = turn_problem(query);
  if (!problem.empty() || query.half_vector_turn.isZero(0)) return problem;
  const FootprintAxes needed =
      footprint_axes(without_needless_periods(query).footprint, map_width, map_height);
  if (!(needed.sigma_major_texels <= kMaxTurnedSigmaTexels))
    return fmt::format(
        "half vector turns over a footprint of {:.3g} x {:.3g} texels (standard deviations), more than {}",
        needed.sigma_major_texels, needed.sigma_minor_texels, kMaxTurnedSigmaTexels);
  return {};
}

LobeAxes lobe_axes(const Query& query) {
  const FootprintAxes axes = footprint_axes({Eigen::Vector2d::Zero(), lobe_covariance(query)}, 1, 1);
  LobeAxes result;
  result.sigma = {axes.sigma_major_texels, axes.sigma_minor_texels};
  result.whiten << axes.major.transpose() / result.sigma[0], axes.minor.transpose() / result.sigma[1];
  return result;
}

Query with_round_lobe(const Query& query) {
  return {query.footprint, query.half_vector, std::sqrt(lobe_axes(query).sigma.prod())};
}

device_types::mica_turned_lobe to_turned_lobe(const Query& query, const device_types::mica_map_grid& grid) {
  const Eigen::Matrix2d whiten = lobe_axes(query).whiten;
  const Eigen::Matrix2d turn =
      whiten * query.half_vector_turn * Eigen::Vector2d(1.0 / grid.width, 1.0 / grid.height).asDiagonal();
  const auto narrow = [](double x) { return static_cast<float>(x); };
  device_types::mica_turned_lobe result{};
  result.lobe_1s = narrow(whiten(0, 0)), result.lobe_1t = narrow(whiten(0, 1));
  result.lobe_2s = narrow(whiten(1, 0)), result.lobe_2t = narrow(whiten(1, 1));
  result.turn_1x = narrow(turn(0, 0)), result.turn_1y = narrow(turn(0, 1));
  result.turn_2x = narrow(turn(1, 0)), result.turn_2y = narrow(turn(1, 1));
  return result;
}

device_types::mica_turned_query to_turned_triangle_query(const Query& query,
                                                         const device_types::mica_map_grid& grid,
                                                         Interpolation interpolation, double cutoff) {
  const Query shorter = without_needless_periods(query), round = with_round_lobe(shorter);
  device_types::mica_turned_query result{};
  result.lobe = to_turned_lobe(shorter, grid);
  // Only without a turn does the map repeat.
  result.map =
      shorter.half_vector_turn.isZero(0)
          ? to_triangle_query(round, grid, interpolation, cutoff)
          : to_map_query(round, round.footprint, footprint_axes(round.footprint, grid.width, grid.height),
                         grid, interpolation, cutoff);
  return result;
}

device_types::mica_turned_mixture_query to_turned_mixture_query(const Query& query,
                                                                const device_types::mica_map_grid& grid,
                                                                Interpolation interpolation, int elements,
                                                                double cutoff) {
  const Query shorter = without_needless_periods(query), round = with_round_lobe(shorter);
  const bool turns = !shorter.half_vector_turn.isZero(0);
  const LobeAxes axes = lobe_axes(shorter);
  device_types::mica_turned_mixture_query result{};
  result.lobe = to_turned_lobe(shorter, grid);
  result.mixture =
      to_mixture_query(round, turns ? round.footprint : without_needless_periods(round.footprint), grid,
                       interpolation, elements, cutoff);
  result.mixture.blur_1 *= static_cast<float>(round.roughness);
  result.mixture.blur_2 *= static_cast<float>(round.roughness);
  result.mixture.map.inverse_roughness = static_cast<float>(1 / axes.sigma[0]);
  // The normals' Jacobian J becomes J - H: (J - H)(J - H)' <= 2 J J' + 2 H H'.
  const double narrower = round.roughness / axes.sigma[0];
  const double a_spread = result.mixture.spread_variance * narrower * narrower;
  const double spread_unit = device_types::MICA_SPREAD_UNIT / (MICA_BOUND_ONE * axes.sigma[0]);
  const double unshared = a_spread / (spread_unit * spread_unit);  // 1 / (1 - share), see to_mixture_query
  const Eigen::Matrix2d turn =
      shorter.half_vector_turn * Eigen::Vector2d(1.0 / grid.width, 1.0 / grid.height).asDiagonal();
  result.mixture.spread_variance = static_cast<float>(2 * a_spread);
  result.spread_turn =
      static_cast<float>(2 * unshared * result.mixture.kernel_variance *
                         largest_eigenvalue(turn * turn.transpose()) / (axes.sigma[0] * axes.sigma[0]));
  result.turn_sx = static_cast<float>(turn(0, 0)), result.turn_sy = static_cast<float>(turn(0, 1));
  result.turn_tx = static_cast<float>(turn(1, 0)), result.turn_ty = static_cast<float>(turn(1, 1));
  return result;
}

}  // namespace mica::host
