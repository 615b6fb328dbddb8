// The levels of merged elements: what merging must keep, and that it does not matter which levels are built.
#include "host/methods/pyramid/moment_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "host/methods/pyramid/cell_moments.h"
#include "host/methods/pyramid/element_tree.h"

namespace mica::host::moment_pyramid_test {
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

std::map<int, PyramidLevel> levels(const Surface& surface, double cell_width, int finest,
                                   bool compact = false) {
  std::map<int, PyramidLevel> all;
  build_moment_pyramid(surface, {cell_width, finest, compact},
                       [&](int block, PyramidLevel level) { all[block] = std::move(level); });
  return all;
}

template <typename Word>
Word word(const std::int16_t* shorts, int place) {
  Word value;
  std::memcpy(&value, shorts + 2 * place, sizeof value);
  return value;
}

int field_of(const std::int16_t* record, int bits, int index, int lane) {
  if (bits == 16) return record[MICA_RECORD_FIELDS_16 + 16 * index + lane];
  std::int8_t field = 0;
  std::memcpy(&field, reinterpret_cast<const char*>(record + MICA_RECORD_FIELDS_8) + 16 * index + lane, 1);
  return field;
}

/// Weight, mean normal and second moments of the normal over all of a level, from its bytes.
struct Total {
  double weight = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
};
Total total_of(const PyramidLevel& level) {
  Total total;
  const int bits = level.shape.record_bits;
  for (std::size_t at = 0; at < level.records.size(); at += record_stride(bits)) {
    const std::int16_t* record = level.records.data() + at;
    const auto field = [&](int index, int lane) { return field_of(record, bits, index, lane); };
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

/// Numbers are rounded to 1.5e-5 or 0.4% of the largest of sixteen; over a level that averages out.
TEST(MomentPyramid, KeepsAreaMeanAndCovarianceOfTheNormals) {
  const Surface surface = noise(150, 90);
  const Total expected = total_of(surface);
  for (const bool compact : {false, true}) {
    const double slack = compact ? 50 : 1, reach = 0.3;  // reach of the normals
    const double mean_slack = 1e-5 + (compact ? reach / (2 * MICA_RECORD_ONE_8) : 0);
    for (const double cell : {0.01, 0.05, 0.3}) {
      for (const int finest : {16, 24}) {
        for (const auto& [block, level] : levels(surface, cell, finest, compact)) {
          const Total total = total_of(level);
          EXPECT_NEAR(total.weight / (150 * 90), 1, 3e-5 * slack) << (compact ? "compact, " : "") << block;
          EXPECT_LT((total.mean - expected.mean).norm() / expected.weight, mean_slack)
              << (compact ? "compact, " : "") << block;
          EXPECT_LT((total.second - expected.second).norm() / expected.second.norm(), 1e-4 * slack)
              << (compact ? "compact, " : "") << block;
        }
      }
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
  const double first = unit * field_of(record, 16, MICA_ELEMENT_WEIGHT, 0),
               second = unit * field_of(record, 16, MICA_ELEMENT_WEIGHT, 1);
  EXPECT_NEAR(first + second, 256, 1e-2);
  EXPECT_NEAR(std::abs(first - second), 128, 1e-2);
}

/// Three cells in a row, the middle one's neighbour on the left nearer; a light one that has no neighbour.
TEST(MomentPyramid, AddsLightCellsToTheirNearestNeighbour) {
  const NormalCells cells(Surface(2, 1, Interpolation::nearest, {{-0.5, -0.5}, {0.5, 0.5}}), 0.1);
  const auto part = [&](double weight, double s, double t) {
    CellMoments moments;
    moments.cell = cells.cell_of(s, t);
    moments.moments.add(weight, Eigen::Vector4d(1, 2, s, t), Eigen::Matrix4d::Zero());
    return moments;
  };
  const std::vector<CellMoments> parts = {part(10, -0.05, -0.45), part(0.1, 0.01, -0.45),
                                          part(10, 0.15, -0.45), part(0.1, 0.45, 0.45)};
  const std::vector<CellMoments> kept = without_light_cells(cells, parts);
  ASSERT_EQ(kept.size(), 3u);
  EXPECT_EQ(kept[0].cell, parts[0].cell);
  EXPECT_NEAR(kept[0].moments.weight, 10.1, 1e-12);
  EXPECT_NEAR(kept[0].moments.mean()[2], (10 * -0.05 + 0.1 * 0.01) / 10.1, 1e-12);
  EXPECT_EQ(kept[1].moments.weight, 10);
  EXPECT_EQ(kept[2].moments.weight, 0.1);
}

TEST(MomentPyramid, EstimatesItsElements) {
  const Surface surface = noise(512, 512);
  const auto actual = static_cast<double>(levels(surface, 0.03, 32).at(32).elements);
  EXPECT_NEAR(estimate_elements(surface, 0.03, 32).whole / actual, 1, 0.25);
  const auto compact = static_cast<double>(levels(surface, 0.03, 32, true).at(32).elements);
  EXPECT_NEAR(estimate_elements(surface, 0.03, 32).compact / compact, 1, 0.25);
}

/// The finest levels whose bytes fit, compact where others do not.
TEST(MomentPyramid, TakesTheFinestLevelsThatFit) {
  const Surface surface = noise(512, 512);
  const auto bytes_of = [&](int finest, bool compact) {
    std::size_t bytes = 0;
    for (const auto& [block, level] : levels(surface, 0.03, finest, compact)) bytes += level.bytes();
    return static_cast<double>(bytes);
  };
  constexpr double room = 1.2;  // for the estimate
  for (const auto& [finest, compact] : {std::pair(16, false), {16, true}, {24, true}, {32, true}}) {
    const PyramidLevels found =
        levels_that_fit(surface, 0.03, static_cast<std::size_t>(room * bytes_of(finest, compact)));
    EXPECT_EQ(found.finest_block, finest) << compact;
    EXPECT_EQ(found.compact, compact) << finest;
  }
  EXPECT_EQ(levels_that_fit(surface, 0.03, 1).finest_block, 512);
}

/// Counting needs no second moments.
TEST(MomentPyramid, CountsTheCellsThatItWouldHave) {
  // Its normals thin out away from their mean.
  const Surface surface =
      make_surface({"test", SpectrumSurface{64, 0.15, 8, 3}, Interpolation::bilinear}, nullptr);
  double all = 0, heavy = 0;
  for (const double width : {0.004, 0.02, 0.06}) {
    const NormalCells cells(surface, width);
    BlockMoments moments(surface, cells);
    CellCounter counter(surface, cells);
    for (const int corner : {0, 32}) {
      std::vector<CellMoments> parts = moments.block(corner, corner, 32);
      const CellCount count = counter.count(corner, corner, 32);
      EXPECT_EQ(count.whole, static_cast<std::int64_t>(parts.size())) << width;
      const std::size_t compact = without_light_cells(cells, std::move(parts)).size();
      EXPECT_EQ(count.compact, static_cast<std::int64_t>(compact)) << width;
      all += static_cast<double>(count.whole), heavy += static_cast<double>(compact);
    }
  }
  EXPECT_LT(heavy, 0.95 * all) << "hardly a cell is light";
}

}  // namespace
}  // namespace mica::host::moment_pyramid_test
