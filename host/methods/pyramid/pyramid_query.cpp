#include "host/methods/pyramid/pyramid_query.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/methods/map/map_query.h"
#include "host/methods/map/turned_query.h"
#include "host/methods/pyramid/moment_pyramid.h"

namespace mica::host {
namespace {

constexpr double kFirstRoughness = 0.02;  // whose cells are not narrower than asked for
constexpr double kSlack = 1e-9;           // of ratios that are meant to be equal
constexpr double kBlendOctaves = 0.25;    // of a footprint's width, over which one level fades into another
constexpr double kUniformVariance = 0.8 * 0.8;  // see without_needless_periods

/// How wide a footprint is, in octaves, beyond where the fading into a uniform one begins; not below zero.
double octaves_into_uniform(const Footprint& footprint) {
  const Eigen::Matrix2d& cov = footprint.cov_uv;
  if (2 * cov.diagonal().minCoeff() < kUniformVariance) return 0;  // as most are
  const double smaller = 0.5 * (cov(0, 0) + cov(1, 1)) - std::hypot(0.5 * (cov(0, 0) - cov(1, 1)), cov(0, 1));
  return std::max(kBlendOctaves + 0.5 * std::log2(std::max(smaller, 1e-30) / kUniformVariance), 0.0);
}

}  // namespace

int cell_class_of(double roughness) {
  return static_cast<int>(std::floor(2 * std::log2(roughness / kFirstRoughness) + kSlack));
}

double cell_width(int cell_class, const PyramidPrecision& precision) {
  return precision.cell_ratio * kFirstRoughness * std::exp2(0.5 * cell_class);
}

std::optional<PyramidShares> shares_of(const Query& query, int map_width, int map_height, int finest_block,
                                       const PyramidPrecision& precision) {
  PyramidShares shares;
  PyramidChoice& choice = shares.choice;
  choice.cell_class = cell_class_of(query.roughness);
  choice.block = whole_map_block(map_width, map_height, finest_block);
  const Footprint footprint = without_needless_periods(query.footprint);
  choice.uniform = footprint.cov_uv == Eigen::Matrix2d::Identity() * kUniformVariance;
  if (choice.uniform) return shares;
  const FootprintAxes axes = footprint_axes(footprint, map_width, map_height);
  if (axes.sigma_major_texels > kLargestAspect * axes.sigma_minor_texels) return std::nullopt;
  // While it fades into a uniform one, a footprint keeps its level.
  const double into_uniform = octaves_into_uniform(footprint);
  const double largest = precision.block_ratio * axes.sigma_minor_texels * std::exp2(-into_uniform);
  if (largest * (1 + kSlack) < finest_block) return std::nullopt;
  while (choice.block > largest * (1 + kSlack)) choice.block /= 2;
  if (choice.block > finest_block)
    shares.finer = std::clamp(1 - std::log2(largest / choice.block) / kBlendOctaves, 0.0, 1.0);
  shares.uniform = std::clamp(into_uniform / kBlendOctaves, 0.0, 1.0);
  return shares;
}

namespace {

device_types::mica_pyramid_query to_pyramid_query(const Query& query, const Footprint& footprint,
                                                  const PyramidShape& level, Interpolation interpolation,
                                                  double cutoff, bool uniform) {
  device_types::mica_pyramid_query result{};
  const int width = level.grid.width, height = level.grid.height;
  result.group_size = level.group_size;
  const FootprintAxes axes = footprint_axes(footprint, width, height);
  result.map = to_map_query(query, footprint, axes, level.grid, interpolation, cutoff);
  if (uniform) {
    // All of the map at once, with the same weight: a footprint so wide that every position counts alike.
    const double sigma = 1e4 * std::max(width, height);
    const auto variance = static_cast<float>(sigma * sigma);
    result.cov_xx = result.cov_yy = variance;
    result.map.whiten_1x = result.map.whiten_2y = static_cast<float>(1 / sigma);
    result.map.whiten_1y = result.map.whiten_2x = 0;
    result.map.extent_x = result.map.extent_y = 0;
    result.map.scale = static_cast<float>(sigma * sigma / (2 * kPi * query.roughness * query.roughness) /
                                          (static_cast<double>(width) * height));
    return result;
  }
  const double variance_1 = axes.sigma_major_texels * axes.sigma_major_texels,
               variance_2 = axes.sigma_minor_texels * axes.sigma_minor_texels;
  const Eigen::Matrix2d cov =
      variance_1 * axes.major * axes.major.transpose() + variance_2 * axes.minor * axes.minor.transpose();
  result.cov_xx = static_cast<float>(cov(0, 0));
  result.cov_xy = static_cast<float>(cov(0, 1));
  result.cov_yy = static_cast<float>(cov(1, 1));
  result.inverse_minor_variance = static_cast<float>(1 / variance_2);
  const double spread = level.spread * level.spread;
  result.map.extent_x = static_cast<float>(std::sqrt(cutoff * (cov(0, 0) + spread)));
  result.map.extent_y = static_cast<float>(std::sqrt(cutoff * (cov(1, 1) + spread)));
  result.map.scale = static_cast<float>(1 / (4 * kPi * kPi * query.roughness * query.roughness));
  return result;
}

}  // namespace

device_types::mica_pyramid_query to_pyramid_query(const Query& query, const PyramidShape& level,
                                                  Interpolation interpolation, double cutoff, bool uniform) {
  return to_pyramid_query(query, without_needless_periods(query.footprint), level, interpolation, cutoff,
                          uniform);
}

Query place_seen(const Query& query) {
  const Eigen::Matrix2d &turn = query.half_vector_turn, lobe = lobe_covariance(query);
  const Eigen::Matrix2d place =
      (query.footprint.cov_uv.inverse() + turn.transpose() * lobe.inverse() * turn).inverse();
  return {{query.footprint.mean_uv, 0.5 * (place + place.transpose())},
          query.half_vector,
          lobe_axes(query).sigma[1]};
}

device_types::mica_turned_pyramid_query to_turned_pyramid_query(const Query& query, const PyramidShape& level,
                                                                Interpolation interpolation, double cutoff,
                                                                bool uniform) {
  Query shorter = without_needless_periods(query);
  if (uniform) {  // place and half vector part
    const Eigen::Matrix2d& turn = query.half_vector_turn;
    shorter.lobe_cov = lobe_covariance(query) + turn * query.footprint.cov_uv * turn.transpose();
    shorter.half_vector_turn.setZero();
  }
  const bool turns = !shorter.half_vector_turn.isZero(0);
  const Query round = with_round_lobe(shorter);
  const double major = lobe_axes(shorter).sigma[0];
  device_types::mica_turned_pyramid_query result{};
  result.lobe = to_turned_lobe(shorter, level.grid);
  result.pyramid =
      to_pyramid_query(round, turns ? round.footprint : without_needless_periods(round.footprint), level,
                       interpolation, cutoff, uniform);
  result.pyramid.map.inverse_roughness = static_cast<float>(1 / major);
  const Eigen::Matrix2d turn = shorter.half_vector_turn *
                               Eigen::Vector2d(1.0 / level.grid.width, 1.0 / level.grid.height).asDiagonal();
  result.turn_sx = static_cast<float>(turn(0, 0)), result.turn_sy = static_cast<float>(turn(0, 1));
  result.turn_tx = static_cast<float>(turn(1, 0)), result.turn_ty = static_cast<float>(turn(1, 1));
  result.spread_turn = static_cast<float>(2 * (turn * turn.transpose()).trace() / (major * major));
  return result;
}

}  // namespace mica::host
