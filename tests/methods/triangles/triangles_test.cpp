// `triangles` against the oracle, against closed forms, and against itself. tests/waves runs its two wave
// forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/surface/texel_footprint.h"
#include "host/verify/accuracy.h"

namespace mica::host::triangles_test {
namespace {

constexpr double kOracleTolerance = 1e-7;  // a thousandth of what is tested

template <typename Kind>
Surface synthesised(const Kind& source, Interpolation interpolation) {
  return make_surface({"test", source, interpolation}, nullptr);
}
Surface spectrum(Interpolation interpolation) {
  return synthesised(SpectrumSurface{256, 0.15, 8, 3}, interpolation);
}
Surface flakes(Interpolation interpolation) {
  return synthesised(FlakesSurface{256, 12, 0.2, 5}, interpolation);
}

/// @param normal of the texel with its centre at (x, y) in [0, 1)^2.
Surface formula(int width, int height, Interpolation interpolation,
                const std::function<Eigen::Vector2d(double x, double y)>& normal) {
  std::vector<Eigen::Vector2d> normals;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) normals.push_back(normal((i + 0.5) / width, (j + 0.5) / height));
  return Surface(width, height, interpolation, std::move(normals));
}
Surface flat(Interpolation interpolation) {
  return formula(256, 256, interpolation, [](double, double) { return Eigen::Vector2d(0.1, -0.05); });
}
/// Rises along u all the way to its step at the wrap: a Jacobian of rank 1.
Surface ramp() {
  return formula(256, 256, Interpolation::bilinear,
                 [](double x, double) { return Eigen::Vector2d(0.8 * x - 0.4, 0.1); });
}
/// Rises and falls along (2, 1), with normals along a line that is not aligned either.
Surface rotated_ramp() {
  return formula(256, 256, Interpolation::bilinear, [](double x, double y) {
    const double phase = 2 * x + y, height = 2 * std::abs(phase - std::floor(phase) - 0.5);
    return Eigen::Vector2d(0.6 * height - 0.3, 0.25 * height);
  });
}
/// Normals all around the rim of the disk.
Surface rim() {
  return formula(256, 256, Interpolation::bilinear, [](double x, double y) {
    const double angle = 2 * kPi * x + 0.7 * std::sin(2 * kPi * y);
    const double radius = 0.999 - 0.1 * std::pow(std::sin(3 * kPi * (x + y)), 2);
    return Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
  });
}
/// Blocks that are partly filled, and a period that is no multiple of a leaf.
Surface odd_size(Interpolation interpolation) {
  return formula(103, 70, interpolation, [](double x, double y) {
    return Eigen::Vector2d(0.3 * std::sin(2 * kPi * (3 * x + y)), 0.2 * std::cos(2 * kPi * (5 * y - 2 * x)));
  });
}

Device& device() {
  static Device shared(0);  // programs are built once for all tests
  return shared;
}

struct SurfaceClass {
  std::string name;
  std::function<Surface()> make;
  double largest_area;  ///< largest area of footprints, texels^2: the oracle visits them all
};

void PrintTo(const SurfaceClass& surface_class, std::ostream* stream) {
  *stream << surface_class.name;
}

class TrianglesPromise : public testing::TestWithParam<SurfaceClass> {};

/// Footprints from 0.1 to 256 texels, round to 100:1, at any angle and place.
std::vector<std::vector<Query>> probes_of(const Surface& surface, double roughness, double largest_area,
                                          std::uint64_t seed) {
  constexpr int footprints = 24;
  constexpr double smallest = 0.1, largest = 256, thinnest = 2e-3;  // texels
  std::vector<std::vector<Query>> probes;
  for (int n = 0; n < footprints; ++n) {
    const auto random = [&](std::uint64_t stream) { return random_unit(seed, stream, n); };
    const double major = smallest * std::pow(largest / smallest, n / (footprints - 1.0));
    const double most_aspect = std::min(100.0, major / thinnest);
    const double least_aspect = std::clamp(major * major / largest_area, 1.0, most_aspect);
    const double aspect = least_aspect * std::pow(most_aspect / least_aspect, random(1));
    const Footprint footprint =
        make_footprint(surface, {random(2), random(3)}, major, major / aspect, kPi * random(4));
    probes.push_back(probe(surface, footprint, roughness, major * major / aspect > 100 ? 6 : 12, seed + n));
  }
  return probes;
}

TEST_P(TrianglesPromise, HoldsAgainstTheOracle) {
  const Surface surface = GetParam().make();
  TriangleEvaluator evaluator(device(), surface);
  const reference::Oracle oracle(surface, kOracleTolerance);
  std::size_t queries = 0;
  std::printf("%-20s worst error in units of the promise, by roughness:", GetParam().name.c_str());
  for (const double roughness : {1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3}) {
    const Accuracy accuracy =
        compare(&evaluator, oracle, surface,
                probes_of(surface, roughness, GetParam().largest_area, 1000 * queries + 7));
    const Query& query = accuracy.worst_query;
    EXPECT_LE(accuracy.worst, 1) << "D = " << accuracy.worst_density << " instead of "
                                 << accuracy.worst_reference << " at uv "
                                 << query.footprint.mean_uv.transpose() << ", covariance "
                                 << query.footprint.cov_uv.reshaped().transpose() << ", half vector "
                                 << query.half_vector.transpose() << ", roughness " << roughness;
    queries += accuracy.queries;
    std::printf(" %g: %.2f", roughness, accuracy.worst);
  }
  std::printf(" (%zu queries)\n", queries);
  EXPECT_GE(queries, 1100u);  // times the classes below: more than 10,000
}

INSTANTIATE_TEST_SUITE_P(
    Surfaces, TrianglesPromise,
    testing::Values(SurfaceClass{"spectrum_bilinear", [] { return spectrum(Interpolation::bilinear); }, 400},
                    SurfaceClass{"spectrum_bicubic", [] { return spectrum(Interpolation::bicubic); }, 40},
                    SurfaceClass{"flakes_nearest", [] { return flakes(Interpolation::nearest); }, 400},
                    SurfaceClass{"flakes_bilinear", [] { return flakes(Interpolation::bilinear); }, 400},
                    SurfaceClass{"flat", [] { return flat(Interpolation::bilinear); }, 400},
                    SurfaceClass{"flat_nearest", [] { return flat(Interpolation::nearest); }, 400},
                    SurfaceClass{"ramp", ramp, 400}, SurfaceClass{"rotated_ramp", rotated_ramp, 400},
                    SurfaceClass{"rim", rim, 400},
                    SurfaceClass{"odd_size_bilinear", [] { return odd_size(Interpolation::bilinear); }, 400},
                    SurfaceClass{"odd_size_bicubic", [] { return odd_size(Interpolation::bicubic); }, 40}),
    [](const testing::TestParamInfo<SurfaceClass>& info) { return info.param.name; });

/// The oracle's cost grows with a footprint's area, so large round footprints are few.
TEST(Triangles, HoldsOnLargeRoundFootprints) {
  for (const Interpolation interpolation : {Interpolation::nearest, Interpolation::bilinear}) {
    const Surface surface =
        interpolation == Interpolation::nearest ? flakes(interpolation) : spectrum(interpolation);
    TriangleEvaluator evaluator(device(), surface);
    const reference::Oracle oracle(surface, kOracleTolerance);
    for (const double sigma_texels : {64.0, 256.0}) {
      const Footprint footprint = make_footprint(surface, {0.9, 0.2}, sigma_texels, 0.7 * sigma_texels, 0.4);
      const Accuracy accuracy = compare(&evaluator, oracle, surface, {probe(surface, footprint, 3e-3, 3, 1)});
      EXPECT_LE(accuracy.worst, 1) << "footprint of " << sigma_texels << " texels";
    }
  }
}

/// Every normal is the same, so footprints do not matter: D is the roughness' Gaussian.
TEST(Triangles, OfAFlatSurfaceIsAGaussian) {
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    const Surface surface = flat(interpolation);
    TriangleEvaluator evaluator(device(), surface);
    for (const double roughness : {1e-3, 0.02, 0.3}) {
      for (const double sigma_texels : {0.1, 1.0, 30.0}) {
        for (const double distance : {0.0, 1.0, 3.0}) {
          Query query{make_footprint(surface, {0.3, 0.8}, sigma_texels, 0.4 * sigma_texels, 1.1),
                      surface.texel(0, 0) + distance * roughness * Eigen::Vector2d(0.6, -0.8), roughness};
          const double expected = std::exp(-0.5 * distance * distance) / (2 * kPi * roughness * roughness);
          EXPECT_NEAR(evaluator.evaluate({query})[0] / expected, 1, 1e-4)
              << "roughness " << roughness << ", footprint " << sigma_texels << ", distance " << distance;
        }
      }
    }
  }
}

/// The sum over a grid that is finer than the roughness is the integral, to far more digits than tested.
TEST(Triangles, IntegratesToOne) {
  const Surface surfaces[] = {spectrum(Interpolation::bilinear), spectrum(Interpolation::bicubic),
                              flakes(Interpolation::nearest), flat(Interpolation::bilinear), ramp()};
  constexpr double roughness = 0.02;
  constexpr int side = 150;  // grid points across [-1, 1]
  for (const Surface& surface : surfaces) {
    TriangleEvaluator evaluator(device(), surface);
    for (const double sigma_texels : {0.3, 6.0}) {
      Query query{make_footprint(surface, {0.45, 0.71}, sigma_texels, 0.2 * sigma_texels, 2.0),
                  Eigen::Vector2d::Zero(), roughness};
      std::vector<Query> queries(side * side, query);
      for (int n = 0; n < side * side; ++n)
        queries[n].half_vector = {(2.0 * (n % side) + 1) / side - 1, (2.0 * (n / side) + 1) / side - 1};
      const std::vector<float> densities = evaluator.evaluate(queries);
      const double integral = std::accumulate(densities.begin(), densities.end(), 0.0) * 4 / (side * side);
      EXPECT_NEAR(integral, 1, 1e-4) << "footprint " << sigma_texels;
      EXPECT_GE(*std::min_element(densities.begin(), densities.end()), 0);
    }
  }
}

/// Queries of all sizes and roughnesses on one surface.
std::vector<Query> mixed_queries(const Surface& surface, int footprints) {
  std::vector<Query> queries;
  for (int n = 0; n < footprints; ++n) {
    const auto random = [&](std::uint64_t stream) { return random_unit(11, stream, n); };
    const double major = 0.2 * std::pow(100, random(0));
    const Footprint footprint =
        make_footprint(surface, {random(1), random(2)}, major, major * std::pow(0.1, random(3)), random(4));
    const std::vector<Query> some = probe(surface, footprint, std::pow(10, -3 + 2.5 * random(5)), 4, n);
    queries.insert(queries.end(), some.begin(), some.end());
  }
  return queries;
}

TEST(Triangles, RepeatTheMapForEver) {
  const Surface surface = spectrum(Interpolation::bilinear);
  TriangleEvaluator evaluator(device(), surface);
  const std::vector<Query> queries = mixed_queries(surface, 100);
  std::vector<Query> far = queries, wrapped = queries;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    far[n].footprint.mean_uv += Eigen::Vector2d(1e7, -1e7);
    const Eigen::Array2d uv = far[n].footprint.mean_uv;  // what doubles hold of it so far away
    wrapped[n].footprint.mean_uv = uv - uv.floor();
  }
  EXPECT_EQ(evaluator.evaluate(far), evaluator.evaluate(wrapped));
}

/// A footprint across the wrap sees what it would see in the middle of the same map, cut elsewhere.
TEST(Triangles, AreTheSameWhereverTheMapIsCut) {
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    const Surface surface = odd_size(interpolation);
    constexpr int cut_i = 37, cut_j = 21;
    std::vector<Eigen::Vector2d> moved;
    for (int j = 0; j < surface.height(); ++j)
      for (int i = 0; i < surface.width(); ++i) moved.push_back(surface.texel(i + cut_i, j + cut_j));
    const Surface cut(surface.width(), surface.height(), interpolation, moved);
    TriangleEvaluator evaluator(device(), surface), cut_evaluator(device(), cut);
    const Eigen::Vector2d shift(1.0 * cut_i / surface.width(), 1.0 * cut_j / surface.height());
    std::vector<Query> queries = mixed_queries(surface, 100), cut_queries = queries;
    for (Query& query : cut_queries) query.footprint.mean_uv -= shift;
    const std::vector<float> whole = evaluator.evaluate(queries);
    const std::vector<float> of_cut = cut_evaluator.evaluate(cut_queries);
    for (std::size_t n = 0; n < queries.size(); ++n) {
      const float peak = *std::max_element(whole.begin() + n / 4 * 4, whole.begin() + n / 4 * 4 + 4);
      EXPECT_NEAR(of_cut[n], whole[n], 1e-4 * whole[n] + 1e-6 * peak) << "query " << n;
    }
  }
}

TEST(Triangles, DependOnTheQueryAlone) {
  const Surface surface = spectrum(Interpolation::bilinear);
  const std::vector<Query> queries = mixed_queries(surface, 500);
  TriangleEvaluator evaluator(device(), surface);
  const std::vector<float> densities = evaluator.evaluate(queries);
  for (const std::size_t batch : {std::size_t{1}, std::size_t{17}, std::size_t{1000}}) {
    TriangleSettings settings;
    settings.batch_queries = batch;
    const std::size_t count = batch == 1 ? 200 : queries.size();  // a launch a query is slow
    const std::vector<Query> some(queries.begin(), queries.begin() + count);
    const std::vector<float> expected(densities.begin(), densities.begin() + count);
    EXPECT_EQ(TriangleEvaluator(device(), surface, settings).evaluate(some), expected)
        << "batches of " << batch;
  }
  std::vector<std::size_t> order(queries.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [](std::size_t a, std::size_t b) { return random_bits(1, 0, a) < random_bits(1, 0, b); });
  std::vector<Query> shuffled(queries.size());
  for (std::size_t n = 0; n < order.size(); ++n) shuffled[n] = queries[order[n]];
  const std::vector<float> shuffled_densities = evaluator.evaluate(shuffled);
  for (std::size_t n = 0; n < order.size(); ++n)
    ASSERT_EQ(shuffled_densities[n], densities[order[n]]) << "query " << order[n] << " at place " << n;
}

TEST(Triangles, TakeAnEmptyBatch) {
  const Surface surface = flat(Interpolation::bilinear);
  EXPECT_TRUE(TriangleEvaluator(device(), surface).evaluate({}).empty());
}

}  // namespace
}  // namespace mica::host::triangles_test
