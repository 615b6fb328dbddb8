// Layers from buffers of several times their width and height.
#include <Eigen/Geometry>
#include <cmath>

#include "mica/error.h"
#include "tests/gbuffer/layer_fixture.h"

namespace mica::host::scale_test {
namespace {

using namespace analytic_buffer;

class Scale : public LayerTest {
 protected:
  LayerResult make_fine(const Camera& camera, const Shape& shape, const LayerSettings& settings,
                        const std::string& scene = materials()) {
    Camera fine = camera;
    fine.width *= settings.scale, fine.height *= settings.scale;
    return make(analytic_buffer::buffer(fine, shape), fine, settings, 0, scene);
  }
};

TEST_F(Scale, OfFourTimesThePixelsLooksAsThePicture) {
  const Camera camera{{5, 1, 1.5}};
  LayerSettings settings;
  settings.scale = 4;
  settings.aovs = {LayerAov::coverage};
  make_fine(camera, sphere, settings);
  const std::vector<float> found = channel("G"), expected = channel(picture(job(camera, kSphere)), "G");
  ASSERT_EQ(found.size(), expected.size());
  double difference2 = 0, square = 0;  // at rims as well
  for (std::size_t n = 0; n < found.size(); ++n) {
    difference2 += std::pow(found[n] - expected[n], 2);
    square += std::pow(expected[n], 2);
  }
  EXPECT_LT(std::sqrt(difference2 / square), 0.02);
  for (const float share : channel("coverage")) EXPECT_TRUE(share >= 0 && share <= 1.0001f) << share;
}

/// The light at rims, where a pixel's sphere begins, is that of the picture whose own samples are many.
TEST_F(Scale, OfFourHasTheLightOfRims) {
  const Camera camera{{5, 1, 1.5}};
  const Image fine = analytic_buffer::buffer({camera.position, 24, 48 * 8, 36 * 8}, sphere);
  const std::vector<float> expected =
      channel(picture(job(camera, kSphere, "filter = \"gaussian\", subpixels = 16")), "G");
  LayerSettings settings;
  settings.scale = 4;
  make_fine(camera, sphere, settings);
  const std::vector<float> found = channel("G");
  const std::vector<float> ids = channel(fine, "ViewLayer.glint_id.X");
  /// Where within a pixel and a half some of it is covered, and some is not.
  const auto is_rim = [&](int row, int column) {
    int covered = 0, all = 0;
    for (int down = 8 * row - 8; down < 8 * row + 16; ++down)
      for (int right = 8 * column - 8; right < 8 * column + 16; ++right, ++all)
        covered += down >= 0 && right >= 0 && down < 36 * 8 && right < 48 * 8 &&
                   ids[static_cast<std::size_t>(down * 48 * 8 + right)] == 1;
    return covered > 0 && covered < all;
  };
  double sum = 0, sum_expected = 0, difference2 = 0, square = 0;
  for (std::size_t n = 0; n < found.size(); ++n) {
    if (!is_rim(static_cast<int>(n) / camera.width, static_cast<int>(n) % camera.width)) continue;
    sum += found[n], sum_expected += expected[n];
    difference2 += std::pow(found[n] - expected[n], 2), square += std::pow(expected[n], 2);
  }
  EXPECT_GT(square, 0);
  EXPECT_NEAR(sum, sum_expected, 0.05 * sum_expected);
  EXPECT_LT(std::sqrt(difference2 / square), 0.05);
}

/// A map of one bump on which a single normal mirrors the lamp: what the layer shows of it is the filter,
/// widened by the bump's own extent.
class FilterOfScale : public Scale {
 protected:
  FilterOfScale() {
    const Eigen::Vector3d half = (camera_.position.normalized() + bulb().normalized()).normalized();
    Image map{256, 256, {"R", "G", "B"}, {}, {}};
    for (int row = 0; row < 256; ++row)
      for (int column = 0; column < 256; ++column) {
        const bool is_bump = std::hypot(row - 127.5, column - 127.5) < 2;
        const Eigen::Vector3d normal = is_bump ? half : Eigen::Vector3d(0, 0, 1);
        for (int k = 0; k < 3; ++k) map.pixels.push_back(static_cast<float>(normal[k]));
      }
    write_exr(path("bump.exr"), map);
  }

  /// Along a row, pixels^2: of four pictures, a quarter of a pixel apart.
  double variance(FilterKind kind, int scale) {
    LayerSettings settings;
    settings.filter.kind = kind, settings.scale = scale;
    double sum = 0, mean = 0, square = 0;
    for (const double phase : {0.0, 0.25, 0.5, 0.75}) {
      const double shift = phase * camera_.pixel() * camera_.position.norm();
      make_fine(
          camera_,
          [&](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
            auto surface = plane(origin, direction);
            const Eigen::Vector3d to_right = camera_.right();  // in the plane
            if (surface) surface->uv += shift / 4 * to_right.head<2>();
            return surface;
          },
          settings,
          "surface.bump = { file = \"bump.exr\", encoding = \"signed\" }\n"
          "material.a = { surface = \"bump\", ndf = \"triangles\", roughness = 0.05, id = 1 }\n");
      const std::vector<float> light = channel("R");
      for (std::size_t n = 0; n < light.size(); ++n) {
        const double x = static_cast<double>(n % static_cast<std::size_t>(camera_.width)) + phase;
        sum += light[n], mean += light[n] * x, square += light[n] * x * x;
      }
    }
    EXPECT_GT(sum, 0);
    return square / sum - std::pow(mean / sum, 2);
  }

  const Camera camera_{{0.5, -4, 3}, 8, 16, 12};
};

TEST_F(FilterOfScale, IsThatOfThePicture) {
  const double gaussian = variance(FilterKind::gaussian, 1),
               harris = variance(FilterKind::blackman_harris, 1);
  EXPECT_NEAR(gaussian - harris, 0.25 - 0.0432, 0.01);  // that of the window by its definition
  for (const int scale : {2, 4}) EXPECT_NEAR(variance(FilterKind::gaussian, scale), gaussian, 0.01) << scale;
  for (const int scale : {4, 8})
    EXPECT_NEAR(variance(FilterKind::blackman_harris, scale), harris, 0.05 * 0.0432) << scale;
  EXPECT_NEAR(variance(FilterKind::box, 4), gaussian - 0.25 + 1 / 12.0, 0.01);
}

TEST_F(Scale, RefusesAFilterThatIsNarrowerThanItsSamples) {
  const Camera camera{{0.5, -4, 3}};
  LayerSettings settings;
  settings.filter.kind = FilterKind::blackman_harris, settings.scale = 2;
  try {
    make_fine(camera, plane, settings);
    ADD_FAILURE();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("0.39 pixels in place of 0.21; expected 1, or 4 or more"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace mica::host::scale_test
