#include <gtest/gtest.h>

#include <cmath>

#include "host/base/constants.h"
#include "host/image/image.h"
#include "host/scene/background.h"
#include "tests/image/folder.h"

namespace mica::host::background_test {
namespace {

using BackgroundTest = FolderTest;

TEST_F(BackgroundTest, ColorIsTheSameEverywhere) {
  const Background background({{0.1, 0.2, 0.3}, ""});
  EXPECT_EQ(background.radiance({1, 2, 3}), Color(0.1, 0.2, 0.3));
  EXPECT_EQ(background.radiance({0, 0, -1}), Color(0.1, 0.2, 0.3));
}

TEST_F(BackgroundTest, ImageSpansAllDirections) {
  // 8 x 4 pixels that hold their own column, row and 1.
  Image image{8, 4, {"R", "G", "B"}, {}, {}};
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 8; ++column)
      image.pixels.insert(image.pixels.end(), {static_cast<float>(column), static_cast<float>(row), 1});
  write_exr(path("sky.exr"), image);
  const Background background({{9, 9, 9}, path("sky.exr")});

  // At the centres of pixels: angle to the right of +y, angle from +z.
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 8; ++column) {
      const double right = (column + 0.5 - 4) / 8 * 2 * kPi, down = (row + 0.5) / 4 * kPi;
      const Eigen::Vector3d direction(std::sin(right) * std::sin(down), std::cos(right) * std::sin(down),
                                      std::cos(down));
      EXPECT_TRUE(background.radiance(2.5 * direction).isApprox(Color(column, row, 1), 1e-6))
          << column << " " << row;
    }
  // Halfway between: the middle of the image is +y, the quarter to the right +x; the far seam joins columns 7
  // and 0.
  EXPECT_TRUE(background.radiance({0, 1, 0}).isApprox(Color(3.5, 1.5, 1), 1e-6));
  EXPECT_TRUE(background.radiance({1, 0, 0}).isApprox(Color(5.5, 1.5, 1), 1e-6));
  EXPECT_TRUE(background.radiance({0, -1, 0}).isApprox(Color(3.5, 1.5, 1), 1e-6));
  EXPECT_NEAR(background.radiance({0, 0, 1}).y(), 0, 1e-6);
  EXPECT_NEAR(background.radiance({0, 0, -1}).y(), 3, 1e-6);
}

TEST_F(BackgroundTest, UnusableImagesAreRefused) {
  EXPECT_EQ(error([&] {
              Background({{0, 0, 0}, path("none.exr")});
            }),
            path("none.exr") + ": cannot read: No such file or directory");
}

}  // namespace
}  // namespace mica::host::background_test
