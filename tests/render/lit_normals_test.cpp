// Queries that are not asked, against what `triangles` answer to them.
#include "host/render/lit_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/methods/triangles/triangle_evaluator.h"

namespace mica::host::lit_normals_test {
namespace {

/// Bumps of a few texels, not as wide as high, of which a corner is far steeper than the rest.
Surface bumps(Interpolation interpolation) {
  constexpr int width = 72, height = 40;
  std::vector<Eigen::Vector2d> normals;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const double steep = i > 60 && j > 30 ? 0.6 : 0.1;
      normals.push_back(steep *
                        Eigen::Vector2d(std::sin(i * 0.7 + j * j * 0.05), std::cos(j * 0.9 - i * 0.3)));
    }
  return {width, height, interpolation, normals};
}

std::vector<Query> queries(bool turn) {
  std::vector<Query> all;
  for (std::uint64_t n = 0; n < 4000; ++n) {
    const auto random = [&](std::uint64_t k) { return random_unit(3, n, k); };
    Query query;
    query.footprint.mean_uv = {random(0), random(1)};
    Eigen::Matrix2d axes;
    axes << random(2), random(3) - 0.5, random(4) - 0.5, random(5);
    axes *= 0.002 + 0.05 * random(6);
    query.footprint.cov_uv = axes * axes.transpose() + 1e-6 * Eigen::Matrix2d::Identity();
    query.footprint.cov_uv(1, 0) = query.footprint.cov_uv(0, 1);
    query.half_vector = Eigen::Vector2d(random(7) - 0.5, random(8) - 0.5);
    query.roughness = 0.003 + 0.02 * random(9);
    if (turn) {
      query.half_vector_turn << random(10) - 0.5, random(11) - 0.5, random(12) - 0.5, random(13) - 0.5;
      query.half_vector_turn *= 4;
      Eigen::Matrix2d lobe;
      lobe << 4, 1, 1, 2;
      query.lobe_cov = query.roughness * query.roughness * lobe;
    }
    all.push_back(query);
  }
  return all;
}

void expect_dropped_are_dark(Interpolation interpolation, bool turn) {
  const Surface surface = bumps(interpolation);
  Device device(0);
  TriangleEvaluator triangles(device, surface);
  const LitNormals lit(surface);
  const std::vector<Query> asked = queries(turn);
  const std::vector<float> densities = triangles.evaluate(asked);
  int dropped = 0, dark = 0;
  for (std::size_t n = 0; n < asked.size(); ++n) {
    dark += densities[n] == 0 ? 1 : 0;
    if (lit.may_answer(asked[n])) continue;
    ++dropped;
    const double peak = 1 / (2 * kPi * std::sqrt(lobe_covariance(asked[n]).determinant()));
    EXPECT_LE(densities[n], 1e-7 * peak) << n;
  }
  std::printf("%d of %zu dark, %d dropped\n", dark, asked.size(), dropped);
  EXPECT_GT(dropped, 0.5 * dark);
  EXPECT_LT(dark, 0.95 * static_cast<double>(asked.size())) << "a test of nothing";
}

TEST(LitNormals, DropOnlyWhatIsDark) {
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic})
    expect_dropped_are_dark(interpolation, false);
}

TEST(LitNormals, FollowHalfVectorsThatTurn) {
  expect_dropped_are_dark(Interpolation::bilinear, true);
}

}  // namespace
}  // namespace mica::host::lit_normals_test
