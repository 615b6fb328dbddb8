#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/methods/evaluator.h"
#include "host/reference/oracle.h"
#include "host/surface/interpolate.h"
#include "host/surface/synthesis.h"
#include "host/surface/texel_footprint.h"
#include "host/verify/accuracy.h"

namespace mica::host {

/// A query by its axes.
/// @param turns of the half vector, in standard deviations of the lobe's major axis, over the footprint's
/// major axis.
inline Query turned_query(const Surface& surface, const Eigen::Vector2d& mean_uv, double sigma_major_texels,
                          double sigma_minor_texels, double angle, double lobe_major, double lobe_minor,
                          double lobe_angle, double turns) {
  Query query;
  query.footprint = make_footprint(surface, mean_uv, sigma_major_texels, sigma_minor_texels, angle);
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(lobe_angle).toRotationMatrix();
  const Eigen::Vector2d variances(lobe_major * lobe_major, lobe_minor * lobe_minor);
  Eigen::Matrix2d lobe = rotation * variances.asDiagonal() * rotation.transpose();
  lobe(1, 0) = lobe(0, 1);
  query.lobe_cov = lobe;
  // Turned and sheared as a sphere's half vectors are over an oblique footprint.
  Eigen::Matrix2d shape;
  shape << std::cos(lobe_angle + angle), -std::sin(lobe_angle + angle), 0.7 * std::sin(lobe_angle + angle),
      0.7 * std::cos(lobe_angle + angle);
  query.half_vector_turn = turns * lobe_major / sigma_major_texels * shape *
                           Eigen::Vector2d(surface.width(), surface.height()).asDiagonal();
  return query;
}

struct FirstOrderSurface {
  std::string name;
  std::function<Surface()> make;
  double largest_texels;  ///< of footprints: the oracle visits all of their texels
};

inline void PrintTo(const FirstOrderSurface& surface, std::ostream* stream) {
  *stream << surface.name;
}

/// Six kinds of maps.
inline std::vector<FirstOrderSurface> first_order_surfaces() {
  const auto made = [](const auto& source, Interpolation interpolation) {
    return [=] { return make_surface({"test", source, interpolation}, nullptr); };
  };
  const auto rim = [] {
    std::vector<Eigen::Vector2d> normals;
    for (int n = 0; n < 103 * 70; ++n) {
      const double x = (n % 103 + 0.5) / 103, y = (n / 103 + 0.5) / 70;
      const double angle = 2 * kPi * x + 0.7 * std::sin(2 * kPi * y);
      const double radius = 0.999 - 0.1 * std::pow(std::sin(3 * kPi * (x + y)), 2);
      normals.push_back(radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    return Surface(103, 70, Interpolation::bilinear, std::move(normals));
  };
  return {{"spectrum_bilinear", made(SpectrumSurface{256, 0.15, 8, 3}, Interpolation::bilinear), 10},
          {"spectrum_bicubic", made(SpectrumSurface{256, 0.15, 8, 3}, Interpolation::bicubic), 4},
          {"flakes_nearest", made(FlakesSurface{256, 12, 0.2, 5}, Interpolation::nearest), 10},
          {"flakes_bilinear", made(FlakesSurface{256, 12, 0.2, 5}, Interpolation::bilinear), 10},
          {"flat", made(SpectrumSurface{64, 1e-6, 8, 3}, Interpolation::bilinear), 10},
          {"rim_of_odd_size", rim, 10}};
}

/// @param order 0: without a turn and with round lobes.
/// Queries, by footprint: of 0.3 to `largest_texels` texels, to 4:1; lobes to 4:1 of a geometric mean `lobe`;
/// half vectors that turn by 0.1 to 4 lobes over the footprint's standard deviation. They are where normals
/// less the turn lie under the footprint, near there and in the lobe's tail.
inline std::vector<std::vector<Query>> first_order_probes(const Surface& surface, double lobe,
                                                          double largest_texels, int footprints = 16,
                                                          int half_vectors = 6, int order = 1,
                                                          double smallest_texels = 0.3) {
  std::vector<std::vector<Query>> probes(footprints);
  for (int n = 0; n < footprints; ++n) {
    const auto random = [&](std::uint64_t stream) { return random_unit(17, stream, n); };
    const auto normal = [&](std::uint64_t stream, std::uint64_t k) {
      return std::sqrt(-2 * std::log(1 - random_unit(23, stream, 100 * n + k))) *
             std::cos(2 * kPi * random_unit(23, stream + 1, 100 * n + k));
    };
    const double major = smallest_texels * std::pow(largest_texels / smallest_texels, n / (footprints - 1.0));
    const double aspect = std::pow(4, random(0)), lobe_aspect = std::pow(4, random(1));
    const double turns = 0.1 * std::pow(40, random(2));
    Query query =
        turned_query(surface, {random(3), random(4)}, major, major / aspect, kPi * random(5),
                     lobe * std::sqrt(lobe_aspect), lobe / std::sqrt(lobe_aspect), kPi * random(6), turns);
    if (order == 0) {
      query.half_vector_turn.setZero();
      query.lobe_cov = lobe * lobe * Eigen::Matrix2d::Identity();
    }
    const Eigen::Matrix2d spread = query.footprint.cov_uv.llt().matrixL(),
                          width = query.lobe_cov->llt().matrixL();
    const Eigen::Vector2d size(surface.width(), surface.height());
    for (int k = 0; k < half_vectors; ++k) {
      const Eigen::Vector2d offset = spread * Eigen::Vector2d(normal(0, k), normal(2, k));
      const double distance = k % 3 == 0 ? 0.3 : k % 3 == 1 ? 1 : 3;
      const Eigen::Vector2d place = (query.footprint.mean_uv + offset).cwiseProduct(size);
      query.half_vector = normal_at(surface, place) - query.half_vector_turn * offset +
                          distance * (width * Eigen::Vector2d(normal(4, k), normal(6, k)));
      if (query.half_vector.cwiseAbs().maxCoeff() <= 1) probes[n].push_back(query);
    }
  }
  return probes;
}

/// Relative L2 error over queries, each footprint's in units of its own root mean square.
inline double relative_l2(Evaluator* evaluator, const References& references,
                          const std::vector<std::vector<Query>>& probes) {
  double sum = 0;
  std::size_t count = 0;
  for (const std::vector<Query>& queries : probes) {
    const std::vector<float> densities = evaluator->evaluate(queries);
    const std::vector<double> expected = references(queries);
    double squares = 0, errors = 0;
    for (std::size_t n = 0; n < queries.size(); ++n) {
      squares += expected[n] * expected[n];
      errors += std::pow(densities[n] - expected[n], 2);
    }
    if (squares > 0) sum += errors / squares, ++count;
  }
  return std::sqrt(sum / static_cast<double>(count));
}

inline References references_of(const reference::Oracle& oracle) {
  return [&oracle](const std::vector<Query>& queries) {
    std::vector<double> densities;
    for (const reference::OracleResult& result : oracle.evaluate(queries))
      densities.push_back(result.density);
    return densities;
  };
}

/// The same probes without a turn and with round lobes, on the normals themselves.
inline std::vector<std::vector<Query>> without_first_order(const Surface& surface, double lobe,
                                                           double largest_texels, int footprints,
                                                           int half_vectors, double smallest_texels = 0.3) {
  return first_order_probes(surface, lobe, largest_texels, footprints, half_vectors, 0, smallest_texels);
}

/// On a flat map D is the lobe about its normal, widened by the turn over the footprint: G2(n - h; S + H C
/// H^T).
/// @param make an evaluator of the map. @param allowed error of a footprint of `sigma` texels, of the peak.
template <typename MakeEvaluator>
void expect_widened_lobes(const MakeEvaluator& make, const std::function<double(double sigma)>& allowed) {
  const Eigen::Vector2d normal(0.1, -0.05);
  const Surface surface(96, 70, Interpolation::bilinear, std::vector<Eigen::Vector2d>(96 * 70, normal));
  auto evaluator = make(surface);
  for (const double sigma : {0.6, 3.0, 10.0, 500.0}) {
    for (const double lobe : {0.004, 0.02}) {
      for (const double turns : {0.0, 0.3, 1.0, 4.0}) {
        for (const double off : {0.0, 1.5, 2.5}) {
          Query query =
              turned_query(surface, {0.3, 0.8}, sigma, 0.5 * sigma, 1.1, lobe, 0.25 * lobe, 0.7, turns);
          const Eigen::Matrix2d wide = lobe_covariance(query) + query.half_vector_turn *
                                                                    query.footprint.cov_uv *
                                                                    query.half_vector_turn.transpose();
          const Eigen::Matrix2d factor = wide.llt().matrixL();
          query.half_vector = normal + off * (factor * Eigen::Vector2d(0.6, -0.8));
          const double peak = 1 / (2 * kPi * std::sqrt(wide.determinant()));
          EXPECT_NEAR(evaluator->evaluate({query})[0] / peak, std::exp(-0.5 * off * off), allowed(sigma))
              << "footprint " << sigma << ", lobe " << lobe << ", turn of " << turns << " lobes, off " << off;
        }
      }
    }
  }
}

}  // namespace mica::host
