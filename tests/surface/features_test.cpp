// Scratches, dents and bumps: their numbers, shapes and slopes.
#include "host/base/constants.h"
#include "mica/error.h"
#include "tests/surface/map_statistics.h"

namespace mica::host::features_test {
namespace {

template <typename Description>
Slopes slopes(const Description& description) {
  return slopes_of(make_surface({"test", description, Interpolation::bilinear}, nullptr).normals());
}

ScratchesSurface scratches() {
  ScratchesSurface description;
  description.resolution = 512;
  description.density = 0.5;
  description.length_texels = 100;
  description.width_texels = 12;
  description.depth_texels = 0.5;
  return description;
}

DentsSurface dents() {
  DentsSurface description;
  description.resolution = 512;
  description.radius_low_texels = 6, description.radius_high_texels = 10;
  return description;
}

BumpsSurface bumps() {
  BumpsSurface description;
  description.resolution = 512;
  description.size = 0.5, description.jitter = 0.5;  // none overlap
  return description;
}

/// A feature's slopes are the differences of a height, that is: the way around a small square rises by
/// nothing.
template <typename Feature>
void expect_gradient(const Feature& feature, double reach) {
  const double side = 1e-3;
  for (int n = 0; n < 500; ++n) {
    const Eigen::Vector2d corner(reach * std::sin(1.7 * n), reach * std::cos(2.3 * n + 1));
    const auto slope = [&](double u, double v) {
      return feature.slope(corner + side * Eigen::Vector2d(u, v));
    };
    const double curl = slope(1, 0.5).y() - slope(0, 0.5).y() - slope(0.5, 1).x() + slope(0.5, 0).x();
    ASSERT_NEAR(curl / side, 0, 1e-4) << corner.transpose();
  }
}

TEST(Features, SlopesAreGradients) {
  Scratch scratch{{0, 0}, Eigen::Vector2d(0.8, 0.6), 40, 5, 0.7, 3, ScratchProfile::rounded};
  expect_gradient(scratch, 30);
  expect_gradient(Dent{{0, 0}, 9, 0.9}, 9);
  const auto inside_cap = Bump{{0, 0}, Eigen::Vector2d(0.6, 0.8), 30, 20, 2.5};
  expect_gradient(inside_cap, 13);  // the rim is a crease
}

TEST(Scratches, AreAsManyLongAndTurnedAsAskedFor) {
  ScratchesSurface description = scratches();
  description.resolution = 4096;
  description.direction_degrees = 30, description.spread_degrees = 20;
  const std::vector<Scratch> placed = place_scratches(description);
  const auto count = static_cast<double>(placed.size());
  EXPECT_NEAR(count, 0.5 * 4096 * 4096 / (100 * 12), 1);
  double length = 0, area = 0, depth = 0, degrees = 0, squares = 0;
  for (const Scratch& scratch : placed) {
    length += 2 * scratch.half_length / count;
    area += 4 * scratch.half_length * scratch.half_width;
    depth += scratch.depth / count;
    const double turn = std::atan2(scratch.direction.y(), scratch.direction.x()) * 180 / kPi - 30;
    degrees += turn / count, squares += turn * turn / count;
    EXPECT_LE(std::abs(turn), 20 + 1e-9);
    EXPECT_LE(std::abs(scratch.half_length - 50), 25);
  }
  // Means of uniform numbers over +-r: a standard deviation of r / sqrt(3 count); four of them.
  const double off = 4 / std::sqrt(3 * count);
  EXPECT_NEAR(length, 100, 50 * off);
  EXPECT_NEAR(depth, 0.5, 0.25 * off);
  EXPECT_NEAR(degrees, 0, 20 * off);
  EXPECT_NEAR(squares / (400.0 / 3), 1, 4 * std::sqrt(0.8 / count));
  EXPECT_NEAR(area / (4096.0 * 4096), 0.5, 0.5 * 2 * off);
}

TEST(Scratches, CoverWhatTheirNumberCovers) {
  ScratchesSurface description = scratches();
  description.resolution = 1024;
  const Slopes map = slopes(description);
  const auto marked =
      std::count_if(map.begin(), map.end(), [](const auto& slope) { return slope.norm() > 0; });
  // Random places that overlap by chance leave exp(-density) free.
  EXPECT_NEAR(static_cast<double>(marked) / static_cast<double>(map.size()), 1 - std::exp(-0.5), 0.02);
}

TEST(Scratches, HaveTheSlopesOfTheirProfiles) {
  // Heights at random places add up without correlation, so E[p^2 + q^2] is the features' number times the
  // integral of one's |gradient|^2, over the area. Along a straight scratch, the square of its depth's share
  // 1 - t^4 integrates to 64/45, and that of its derivative to 32/7.
  for (const ScratchProfile profile : {ScratchProfile::v, ScratchProfile::rounded}) {
    ScratchesSurface description = scratches();
    description.resolution = 1024;
    description.variation = 0, description.width_texels = 16, description.density = 1;
    description.profile = profile;
    const int steps = 2000;
    double slope_square = 0, height_square = 0;
    for (int n = 0; n < steps; ++n) {
      const double x = 2 * (n + 0.5) / steps - 1, y = x * x;
      const double height = profile == ScratchProfile::v ? 1 - std::abs(x) : (1 - y) * (1 - y) * (1 - 3 * y);
      const double slope = profile == ScratchProfile::v ? 1 : 2 * x * (1 - y) * (9 * y - 5);
      slope_square += slope * slope * 2 / steps, height_square += height * height * 2 / steps;
    }
    const double half_length = 50, half_width = 8, depth = 0.5, count = 1024.0 * 1024 / (100 * 16);
    const double one = depth * depth *
                       (64.0 / 45 * slope_square * half_length / half_width +
                        32.0 / 7 * height_square * half_width / half_length);
    EXPECT_NEAR(std::sqrt(mean_square(slopes(description)) / (std::round(count) * one / (1024.0 * 1024))), 1,
                0.02);
  }
}

TEST(Dents, AreAsManyAndAsSteepAsAskedFor) {
  DentsSurface description = dents();
  description.resolution = 1024;
  const std::vector<Dent> placed = place_dents(description);
  const double mean_squared_radius = (36 + 60 + 100) / 3.0;
  EXPECT_NEAR(static_cast<double>(placed.size()), 0.5 * 1024 * 1024 / (kPi * mean_squared_radius), 1);
  double radius = 0;
  for (const Dent& dent : placed) {
    EXPECT_GE(dent.radius, 6);
    EXPECT_LE(dent.radius, 10);
    EXPECT_DOUBLE_EQ(dent.depth, 0.1 * dent.radius);
    radius += dent.radius / static_cast<double>(placed.size());
  }
  EXPECT_NEAR(radius, 8, 4 * 2 / std::sqrt(3.0 * static_cast<double>(placed.size())));
  EXPECT_NEAR(std::sqrt(mean_square(slopes(description)) / (1.2 * 0.5 * 0.1 * 0.1)), 1, 0.02);
}

TEST(Dents, GoDownInTheirMiddle) {
  const Dent dent{{0, 0}, 10, 1};
  EXPECT_GT(dent.slope({3, 0}).x(), 0);
  // From the middle to the rim: the depth.
  double rise = 0;
  for (int n = 0; n < 1000; ++n) rise += dent.slope({(n + 0.5) / 100, 0}).x() / 100;
  EXPECT_NEAR(rise, 1, 1e-6);
}

TEST(Bumps, AreOneACellAndAsSteepAsAskedFor) {
  const BumpsSurface description = bumps();
  const std::vector<Bump> placed = place_bumps(description);
  const double cell = 512 / 21.0;  // 24 texels do not divide 512
  ASSERT_EQ(placed.size(), 21u * 21u);
  for (std::size_t n = 0; n < placed.size(); ++n) {
    const Eigen::Vector2d middle =
        cell * Eigen::Vector2d(static_cast<double>(n % 21) + 0.5, static_cast<double>(n / 21) + 0.5);
    EXPECT_LE((placed[n].center_texels - middle).cwiseAbs().maxCoeff(), cell / 4);
  }
  const double width = placed[0].half_width;
  const Eigen::Vector2d across(-placed[0].long_axis.y(), placed[0].long_axis.x());
  EXPECT_NEAR(placed[0].slope(across * width * (1 - 1e-9)).norm(), 0.3, 1e-6);
  EXPECT_LT(placed[0].slope(across * width / 2).dot(across), 0) << "bumps rise to their middle";
}

TEST(Bumps, HaveTheSlopesOfTheirEllipsoids) {
  // The integral of |gradient|^2 over one cap; K^2 = 1 + 1/slope^2.
  const BumpsSurface description = bumps();
  const double length = 0.5 * 512 / 21 / 2, width = length / 1.5, squared = 1 + 1 / (0.3 * 0.3);
  const double one =
      length * width * (1 / (1.5 * 1.5) + 1) * kPi / 2 * (-1 - squared * std::log1p(-1 / squared));
  EXPECT_NEAR(std::sqrt(mean_square(slopes(description)) / (21 * 21 * one / (512.0 * 512))), 1, 0.02);
}

TEST(Features, HaveNoSeam) {
  ScratchesSurface narrow = scratches();
  narrow.resolution = 256, narrow.length_texels = 200, narrow.width_texels = 5, narrow.bend = 0.1;
  expect_no_seam(slopes(narrow), 256);
  expect_no_seam(slopes(dents()), 512);
  BumpsSurface close = bumps();
  close.cell_texels = 16, close.size = 1.2;  // they overlap, and reach across the seam
  close.jitter = 1;
  expect_no_seam(slopes(close), 512);
}

TEST(Features, ASeamWouldBeSeen) {
  // The left half of a map is one that does not repeat.
  const Slopes whole = slopes(dents());
  Slopes half;
  for (int j = 0; j < 256; ++j)
    for (int i = 0; i < 256; ++i) half.push_back(whole[j * 512 + i]);
  EXPECT_GT(seam_score(half, 256), 4);
  EXPECT_GT(seam_score(transposed(half, 256), 256), 4);
}

TEST(Features, DoNotDependOnTheNumberOfThreads) {
  const auto same = [](const auto& description) {
    expect_same_on_any_threads([&] {
      return make_surface({"test", description, Interpolation::bilinear}, nullptr).normals();
    });
  };
  ScratchesSurface crossing = scratches();
  crossing.resolution = 200, crossing.density = 4;
  same(crossing);
  same(dents());
  same(bumps());
}

TEST(Features, AreFlatWithoutHeightAndDifferByTheSeed) {
  ScratchesSurface none = scratches();
  none.density = 0;
  EXPECT_EQ(mean_square(slopes(none)), 0);
  BumpsSurface flat = bumps();
  flat.slope = 0;
  EXPECT_EQ(mean_square(slopes(flat)), 0);
  DentsSurface other = dents();
  other.seed = 2;
  EXPECT_NE(slopes(other), slopes(dents()));
}

TEST(Scratches, WarnWhenTheGridDoesNotResolveThem) {
  SurfaceReport report;
  synthesise_scratches(scratches(), report);
  EXPECT_TRUE(report.warnings.empty());
  ScratchesSurface narrow = scratches();
  narrow.width_texels = 7.9;
  synthesise_scratches(narrow, report);
  EXPECT_EQ(report.warnings.size(), 1u);
}

TEST(Features, RefuseSettingsOutOfRange) {
  const double nan = std::nan("");
  ScratchesSurface scratch = scratches();
  for (double ScratchesSurface::*setting :
       {&ScratchesSurface::density, &ScratchesSurface::length_texels, &ScratchesSurface::width_texels,
        &ScratchesSurface::depth_texels, &ScratchesSurface::variation, &ScratchesSurface::direction_degrees,
        &ScratchesSurface::spread_degrees, &ScratchesSurface::bend}) {
    for (const double value : {nan, -1000.0, 1000.0}) {
      scratch = scratches();
      scratch.*setting = value;
      EXPECT_THROW(place_scratches(scratch), UsageError) << value;
    }
  }
  DentsSurface dent = dents();
  dent.radius_low_texels = 11;  // above the greatest
  EXPECT_THROW(place_dents(dent), UsageError);
  BumpsSurface bump = bumps();
  bump.cell_texels = 3;
  EXPECT_THROW(place_bumps(bump), UsageError);
}

}  // namespace
}  // namespace mica::host::features_test
