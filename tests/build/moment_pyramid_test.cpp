// The levels of merged elements: what merging must keep, and that it does not matter which levels are built.
#include "host/build/moment_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "host/build/cell_moments.h"

namespace mica {
namespace {

using namespace device_types;

Surface noise(int width, int height) {
  std::vector<Eigen::Vector2d> normals;
  for (int n = 0; n < width * height; ++n) {
    const double x = 0.37 * (n % width), y = 0.23 * (n / width);
    normals.emplace_back(0.3 * std::sin(x + std::cos(y)), 0.2 * std::sin(1.3 * y + 0.4 * x));
  }
  return Surface(width, height, Interpolation::bilinear, std::move(normals));
}

std::map<int, PyramidLevel> levels(const Surface& surface, double cell_width, int finest) {
  std::map<int, PyramidLevel> all;
  build_moment_pyramid(surface, cell_width, finest,
                       [&](int block, PyramidLevel level) { all[block] = std::move(level); });
  return all;
}

template <typename Word>
Word word(const std::int16_t* shorts, int place) {
  Word value;
  std::memcpy(&value, shorts + 2 * place, sizeof value);
  return value;
}

/// Weight, mean normal and second moments of the normal over all of a level, from its bytes.
struct Total {
  double weight = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
};
Total total_of(const PyramidLevel& level) {
  Total total;
  for (std::size_t at = 0; at < level.records.size(); at += MICA_RECORD_STRIDE) {
    const std::int16_t* record = level.records.data() + at;
    const auto field = [&](int index, int lane) { return record[MICA_RECORD_FIELDS + 16 * index + lane]; };
    for (int lane = 0; lane < 16; ++lane) {
      const double weight = word<float>(record, MICA_RECORD_WEIGHT_UNIT) * field(MICA_ELEMENT_WEIGHT, lane);
      const double unit = word<float>(record, MICA_RECORD_MEAN_UNIT);
      const double normal_unit = word<float>(record, MICA_RECORD_NORMAL_UNIT);
      const Eigen::Vector2d mean(word<std::int32_t>(record, MICA_RECORD_ORIGIN_S) / 1073741824.0 +
                                     unit * field(MICA_ELEMENT_S, lane),
                                 word<std::int32_t>(record, MICA_RECORD_ORIGIN_T) / 1073741824.0 +
                                     unit * field(MICA_ELEMENT_T, lane));
      Eigen::Matrix2d covariance;
      covariance << field(MICA_ELEMENT_SS, lane), field(MICA_ELEMENT_ST, lane), field(MICA_ELEMENT_ST, lane),
          field(MICA_ELEMENT_TT, lane);
      total.weight += weight;
      total.mean += weight * mean;
      total.second += weight * (normal_unit * covariance + mean * mean.transpose());
    }
  }
  return total;
}

/// Two linear triangles a quad, integrated by the three midpoints of their edges: exact for squares.
Total total_of(const Surface& surface) {
  Total total;
  for (int j = 0; j < surface.height(); ++j) {
    for (int i = 0; i < surface.width(); ++i) {
      const Eigen::Vector2d right = surface.texel(i + 1, j), top = surface.texel(i, j + 1);
      for (const Eigen::Vector2d& corner : {surface.texel(i, j), surface.texel(i + 1, j + 1)}) {
        for (const Eigen::Vector2d& middle :
             {Eigen::Vector2d(0.5 * (corner + right)), Eigen::Vector2d(0.5 * (corner + top)),
              Eigen::Vector2d(0.5 * (right + top))}) {
          total.weight += 1.0 / 6;
          total.mean += middle / 6;
          total.second += middle * middle.transpose() / 6;
        }
      }
    }
  }
  return total;
}

/// 16 bits a number: 2e-5 of each.
TEST(MomentPyramid, KeepsAreaMeanAndCovarianceOfTheNormals) {
  const Surface surface = noise(150, 90);
  const Total expected = total_of(surface);
  for (const double cell : {0.01, 0.05, 0.3}) {
    for (const auto& [block, level] : levels(surface, cell, 16)) {
      const Total total = total_of(level);
      EXPECT_NEAR(total.weight / (150 * 90), 1, 3e-5) << block;
      EXPECT_LT((total.mean - expected.mean).norm() / expected.weight, 1e-5) << block;
      EXPECT_LT((total.second - expected.second).norm() / expected.second.norm(), 1e-4) << block;
    }
  }
}

TEST(MomentPyramid, LevelsAreTheSameBytesWhicheverAreBuilt) {
  const Surface surface = noise(150, 90);
  const std::map<int, PyramidLevel> fine = levels(surface, 0.03, 16), coarse = levels(surface, 0.03, 64);
  EXPECT_EQ(fine.size(), 5u);  // 16, 32, 64, 128, 256
  for (const auto& [block, level] : coarse) {
    EXPECT_EQ(level.records, fine.at(block).records);
    EXPECT_EQ(level.nodes, fine.at(block).nodes);
    EXPECT_EQ(level.top_nodes, fine.at(block).top_nodes);
    EXPECT_EQ(level.groups, fine.at(block).groups);
  }
}

/// At most one element a block and cell, and cells that merge.
TEST(MomentPyramid, MergesMoreTheCoarserItIs) {
  const Surface surface = noise(256, 256);
  const std::map<int, PyramidLevel> all = levels(surface, 0.05, 16);
  const auto cells = static_cast<std::size_t>(NormalCells(surface, 0.05).count());
  EXPECT_LE(all.at(256).elements, cells);
  EXPECT_LT(2 * all.at(64).elements, all.at(16).elements);
  EXPECT_EQ(all.at(256).groups.size(), 2u);
}

/// Two flakes in one block: two elements, each the size of its flake.
TEST(MomentPyramid, KeepsFlakesApart) {
  std::vector<Eigen::Vector2d> normals(16 * 16);
  for (int n = 0; n < 16 * 16; ++n) normals[n] = {n % 16 < 4 ? -0.2 : 0.2, 0.0};
  const Surface surface(16, 16, Interpolation::nearest, normals);
  const PyramidLevel level = levels(surface, 0.1, 16).at(16);
  ASSERT_EQ(level.elements, 2u);
  const std::int16_t* record = level.records.data();
  const double unit = word<float>(record, MICA_RECORD_WEIGHT_UNIT);
  EXPECT_NEAR(unit * record[MICA_RECORD_FIELDS] + unit * record[MICA_RECORD_FIELDS + 1], 256, 1e-2);
  EXPECT_NEAR(std::abs(unit * record[MICA_RECORD_FIELDS] - unit * record[MICA_RECORD_FIELDS + 1]), 128, 1e-2);
}

TEST(MomentPyramid, EstimatesItsBytes) {
  const Surface surface = noise(512, 512);
  const double actual = static_cast<double>(levels(surface, 0.03, 32).at(32).bytes());
  EXPECT_NEAR(static_cast<double>(estimate_level_bytes(surface, 0.03, 32)) / actual, 1, 0.25);
}

}  // namespace
}  // namespace mica
