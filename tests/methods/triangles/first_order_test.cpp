// `triangles` on queries whose half vector turns over the footprint and whose lobe is not round.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/verify/accuracy.h"
#include "tests/methods/first_order_queries.h"

namespace mica::host::first_order_triangles_test {
namespace {

Device& device() {
  static Device shared(0);
  return shared;
}

class TrianglesFirstOrder : public testing::TestWithParam<FirstOrderSurface> {};

/// The promise: 1e-4 D + 1e-6 of the peak.
TEST_P(TrianglesFirstOrder, HoldsAgainstTheOracle) {
  const Surface surface = GetParam().make();
  TriangleEvaluator evaluator(device(), surface);
  const reference::Oracle oracle(surface, 1e-7);
  double worst = 0;
  std::size_t count = 0;
  std::printf("%-20s worst error in units of the promise, by lobe:", GetParam().name.c_str());
  for (const double lobe : {1e-3, 3e-3, 1e-2, 3e-2, 0.1}) {
    double worst_of_lobe = 0;
    for (const std::vector<Query>& queries : first_order_probes(surface, lobe, GetParam().largest_texels)) {
      const std::vector<float> densities = evaluator.evaluate(queries);
      const std::vector<reference::OracleResult> expected = oracle.evaluate(queries);
      double peak = 0;
      for (const reference::OracleResult& result : expected) peak = std::max(peak, result.density);
      for (std::size_t n = 0; n < queries.size(); ++n) {
        const double promised = 1e-4 * expected[n].density + 1e-6 * peak;
        worst_of_lobe = std::max(worst_of_lobe, std::abs(densities[n] - expected[n].density) / promised);
      }
      count += queries.size();
    }
    std::printf(" %g: %.3f", lobe, worst_of_lobe);
    worst = std::max(worst, worst_of_lobe);
  }
  std::printf(" (%zu queries)\n", count);
  EXPECT_LE(worst, 1);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, TrianglesFirstOrder, testing::ValuesIn(first_order_surfaces()),
                         [](const testing::TestParamInfo<FirstOrderSurface>& info) {
                           return info.param.name;
                         });

TEST(TrianglesFirstOrder, OfAFlatMapIsTheLobeWidenedByTheTurn) {
  const Eigen::Vector2d normal(0.1, -0.05);
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    const Surface surface(96, 70, interpolation, std::vector<Eigen::Vector2d>(96 * 70, normal));
    TriangleEvaluator evaluator(device(), surface);
    // 500 and 3000 texels are many periods: more than the turn lets through, and fewer.
    for (const double sigma : {0.3, 3.0, 10.0, 500.0, 3000.0}) {
      for (const double lobe : {1e-3, 0.02}) {
        for (const double turns : {0.0, 0.1, 1.0, 4.0, 40.0}) {
          if (sigma == 500 && interpolation != Interpolation::bilinear) continue;  // slow
          for (const double off : {0.0, 1.5, 3.0}) {
            Query query =
                turned_query(surface, {0.3, 0.8}, sigma, 0.5 * sigma, 1.1, lobe, 0.25 * lobe, 0.7, turns);
            const Eigen::Matrix2d wide = lobe_covariance(query) + query.half_vector_turn *
                                                                      query.footprint.cov_uv *
                                                                      query.half_vector_turn.transpose();
            const Eigen::Matrix2d factor = wide.llt().matrixL();
            const Eigen::Vector2d step = off * (factor * Eigen::Vector2d(0.6, -0.8));
            query.half_vector = normal + step;
            const double expected = std::exp(-0.5 * off * off) / (2 * kPi * std::sqrt(wide.determinant()));
            EXPECT_NEAR(evaluator.evaluate({query})[0] / expected, 1, 1e-4)
                << "footprint " << sigma << ", lobe " << lobe << ", turn of " << turns << " lobes, off "
                << off;
          }
        }
      }
    }
  }
}

/// A linear slope added to a map, and a half vector that turns alike.
TEST(TrianglesFirstOrder, IsConstantOnAMapThatTurnsAlike) {
  Eigen::Matrix2d slope;
  slope << 0.002, -0.001, 0.0015, 0.003;
  for (const Interpolation interpolation : {Interpolation::bilinear, Interpolation::bicubic}) {
    std::vector<Eigen::Vector2d> normals[2];
    for (int n = 0; n < 128 * 128; ++n) {
      const Eigen::Vector2d noise(random_unit(3, 0, n) - 0.5, random_unit(3, 1, n) - 0.5);
      const Eigen::Vector2d place(n % 128 - 63.5, n / 128 - 63.5);
      normals[0].push_back(0.02 * noise);
      normals[1].push_back(0.02 * noise + slope * place);
    }
    const Surface plain(128, 128, interpolation, normals[0]), sloped(128, 128, interpolation, normals[1]);
    TriangleEvaluator evaluator(device(), plain), sloped_evaluator(device(), sloped);
    for (const double roughness : {1e-3, 3e-3, 0.02}) {
      for (const double sigma : {0.3, 2.0, 8.0}) {
        Query query{make_footprint(plain, {0.53, 0.47}, sigma, 0.4 * sigma, 2.0), {0.002, -0.001}, roughness};
        const double density = evaluator.evaluate({query})[0];
        query.half_vector_turn = slope * 128;
        query.half_vector += query.half_vector_turn * (query.footprint.mean_uv - Eigen::Vector2d(0.5, 0.5));
        EXPECT_NEAR(sloped_evaluator.evaluate({query})[0], density, 1e-4 * density)
            << "roughness " << roughness << ", footprint " << sigma;
      }
    }
  }
}

/// What is absent gives the same bits, also in company of queries that have it.
TEST(TrianglesFirstOrder, CostsPlainQueriesNothing) {
  const Surface surface = first_order_surfaces()[0].make();
  TriangleEvaluator evaluator(device(), surface);
  std::vector<Query> queries;
  for (int n = 0; n < 300; ++n) {
    const auto random = [&](std::uint64_t stream) { return random_unit(5, stream, n); };
    queries.push_back(
        {make_footprint(surface, {random(0), random(1)}, 0.3 + 5 * random(2), 0.3, 3 * random(3)),
         surface.texel(n, 3 * n), 0.003 + 0.02 * random(4)});
  }
  const std::vector<float> densities = evaluator.evaluate(queries);
  std::vector<Query> round = queries, mixed = queries;
  for (Query& query : round) query.lobe_cov = lobe_covariance(query);
  EXPECT_EQ(evaluator.evaluate(round), densities);
  for (std::size_t n = 0; n < queries.size(); n += 3)
    mixed[n].half_vector_turn = 1e-6 * Eigen::Matrix2d::Identity();
  const std::vector<float> mixed_densities = evaluator.evaluate(mixed);
  for (std::size_t n = 0; n < queries.size(); ++n) {
    if (n % 3 != 0) {
      EXPECT_EQ(mixed_densities[n], densities[n]) << n;
    } else {  // a turn of almost nothing changes almost nothing
      EXPECT_NEAR(mixed_densities[n], densities[n], 1e-3 * densities[n] + 1e-3) << n;
    }
  }
}

TEST(TrianglesFirstOrder, DependsOnTheQueryAlone) {
  const Surface surface = first_order_surfaces()[0].make();
  std::vector<Query> queries;
  for (const std::vector<Query>& some : first_order_probes(surface, 0.01, 10))
    queries.insert(queries.end(), some.begin(), some.end());
  TriangleEvaluator evaluator(device(), surface);
  const std::vector<float> densities = evaluator.evaluate(queries);
  TriangleSettings settings;
  settings.batch_queries = 17;
  EXPECT_EQ(TriangleEvaluator(device(), surface, settings).evaluate(queries), densities);
  for (Query& query : queries) query.footprint.mean_uv += Eigen::Vector2d(1024, -1024);
  const std::vector<float> far = evaluator.evaluate(queries);
  for (std::size_t n = 0; n < queries.size(); ++n)
    EXPECT_NEAR(far[n], densities[n], 1e-5 * densities[n] + 1e-6) << n;
}

}  // namespace
}  // namespace mica::host::first_order_triangles_test
