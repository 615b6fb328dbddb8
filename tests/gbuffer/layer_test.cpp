// Layers from the G-buffers of shapes that have formulas, against the pictures of the same shapes.
#include <Eigen/LU>
#include <cmath>

#include "tests/gbuffer/layer_fixture.h"

namespace mica::host::layer_test {
namespace {

using namespace analytic_buffer;

class Layer : public LayerTest {};

/// Relative differences where the picture fits a pixel by one footprint, and the buffer has all its
/// neighbours; or at its border alone, where neighbours on one side are missing.
struct Difference {
  double mean = 0, largest = 0;
  int pixels = 0;
};
Difference difference(const std::vector<float>& found, const std::vector<float>& expected,
                      const std::vector<float>& queries, const std::vector<float>& ids, int width,
                      bool at_border = false) {
  Difference result;
  const float brightest = *std::max_element(expected.begin(), expected.end());
  const int height = static_cast<int>(found.size()) / width;
  const auto has_surface = [&](int row, int column) {
    return ids[static_cast<std::size_t>(row * width + column)] == 1;
  };
  for (std::size_t n = 0; n < found.size(); ++n) {
    const int row = static_cast<int>(n) / width, column = static_cast<int>(n) % width;
    const bool is_border = row == 0 || column == 0 || row == height - 1 || column == width - 1;
    if (is_border != at_border || queries[n] != 1 || expected[n] <= 0.01f * brightest) continue;
    bool inside = has_surface(row, column);
    for (int k = 0; k < 9 && !is_border; ++k)
      inside = inside && has_surface(row + k / 3 - 1, column + k % 3 - 1);
    if (!inside) continue;
    const double error = std::abs(found[n] / expected[n] - 1);
    result.mean += error, result.largest = std::max(result.largest, error), ++result.pixels;
  }
  result.mean /= std::max(result.pixels, 1);
  return result;
}

TEST_F(Layer, OfASphereLooksAsItsPicture) {
  const Camera camera{{5, 1, 1.5}};  // u starts again in the middle of the picture
  const Image buffer = analytic_buffer::buffer(camera, sphere);
  for (const char* filter : {"gaussian", "blackman-harris"}) {
    LayerSettings settings;
    settings.filter.kind = *parse_word<FilterKind>(filter);
    settings.aovs = {LayerAov::density};
    make(buffer, camera, settings);
    const Image expected = picture(job(camera, kSphere, std::string("filter = \"") + filter + "\""));
    if (std::string(filter) != "gaussian") {  // several queries a pixel
      double sum = 0, sum_expected = 0;
      for (const float value : channel("R")) sum += value;
      for (const float value : channel(expected, "R")) sum_expected += value;
      EXPECT_NEAR(sum, sum_expected, 0.1 * sum_expected);  // rims are not alike
      continue;
    }
    const std::vector<float> ids = channel(buffer, "ViewLayer.glint_id.X"),
                             queries = channel(expected, "queries.Y");
    const Difference densities =
        difference(channel("D"), channel(expected, "ndf.Y"), queries, ids, camera.width);
    EXPECT_GT(densities.pixels, 100);
    EXPECT_LT(densities.mean, 0.002);
    EXPECT_LT(densities.largest, 0.02);
    const Difference light = difference(channel("R"), channel(expected, "R"), queries, ids, camera.width);
    EXPECT_LT(light.mean, 0.002);
  }
}

TEST_F(Layer, OfAPlaneLooksAsItsPicture) {
  const Camera camera{{0.5, -4, 3}};
  const Image buffer = analytic_buffer::buffer(camera, plane);
  LayerSettings settings;
  settings.aovs = {LayerAov::density, LayerAov::coverage, LayerAov::footprint};
  make(buffer, camera, settings);
  const Image expected = picture(job(camera, kPlane));
  const std::vector<float> ids = channel(buffer, "ViewLayer.glint_id.X"),
                           queries = channel(expected, "queries.Y");
  const Difference densities =
      difference(channel("D"), channel(expected, "ndf.Y"), queries, ids, camera.width);
  EXPECT_GT(densities.pixels, 150);
  EXPECT_LT(densities.mean, 0.001);
  EXPECT_LT(densities.largest, 0.02);
  const Difference at_border =
      difference(channel("D"), channel(expected, "ndf.Y"), queries, ids, camera.width, true);
  EXPECT_GT(at_border.pixels, 10);
  EXPECT_LT(at_border.largest, 0.05);
  EXPECT_EQ(channel("coverage"), ids);
  for (const float alpha : channel("A")) EXPECT_EQ(alpha, 0);
  EXPECT_EQ(layer_->metadata()["Software"], "a renderer");
}

/// A corner of what Blender 5.3 wrote: many parts, a data window, a lamp's light, another material.
TEST_F(Layer, OfBlendersPlaneLooksAsItsPicture) {
  const std::string file = MICA_TEST_DATA "/blender_5_3_plane";
  const std::string surface =
      "surface.bumps = { generate = \"spectrum\", resolution = 256, rms_slope = 0.4, correlation = 8, seed = "
      "1 }\n"
      "material.a = { surface = \"bumps\", ndf = \"triangles\", repeat = [4, 4], roughness = 0.1, id = 2 }\n";
  LayerSettings settings;
  settings.aovs = {LayerAov::density};
  BufferOptions options;
  options.skips_other_ids = true;
  make(file, options, settings, 0, surface);
  const FileWindow& window = layer_->window();
  EXPECT_EQ(window.top, 44);
  EXPECT_EQ(window.whole_width, 160);
  const Image expected = picture(
      "image = { width = 160, height = 90, filter = \"gaussian\", aovs = [\"ndf\", \"queries\"] }\n"
      "camera = { position = [0, -6, 3], look_at = [0, -5.0611236691474915, 2.6557453572750092], "
      "fov = 22.895194 }\n" +
      surface +
      "shape = [{ type = \"plane\", size = 8, material = \"a\" }]\n"
      "light = [{ type = \"directional\", direction = [0.5642766356468201, 0.2821381390094757, "
      "-0.7758801579475403], irradiance = [2, 2, 2] }]\n");
  const auto part_of = [&](const std::string& name) {
    const std::vector<float> all = channel(expected, name);
    std::vector<float> part;
    for (int row = 0; row < window.height; ++row)
      for (int column = 0; column < window.width; ++column)
        part.push_back(all[static_cast<std::size_t>((row + window.top) * 160 + column)]);
    return part;
  };
  ChannelFile buffer(file + ".exr");
  std::vector<float> ids;
  for (int n = 0; n < static_cast<int>(buffer.channels().size()); ++n)
    if (buffer.channels()[static_cast<std::size_t>(n)].name == "ViewLayer.glint_id.X")
      for (const float id : buffer.read(0, window.height, {n})) ids.push_back(id == 2 ? 1.0f : 0.0f);
  const Difference densities =
      difference(channel("D"), part_of("ndf.Y"), part_of("queries.Y"), ids, window.width);
  EXPECT_GT(densities.pixels, 300);
  EXPECT_LT(densities.mean, 0.001);
  EXPECT_LT(densities.largest, 0.02);
}

TEST_F(Layer, IsTheSameForAnyBlockSize) {
  const Camera camera{{5, 1, 1.5}};
  const Image buffer = analytic_buffer::buffer(camera, sphere);
  for (const int scale : {1, 2}) {
    LayerSettings settings;
    settings.scale = scale;
    make(buffer, camera, settings, camera.height);
    const std::string whole = bytes(path("layer.exr"));
    for (const int rows : {1, 7}) {
      make(buffer, camera, settings, rows);
      EXPECT_EQ(bytes(path("layer.exr")), whole) << rows;
    }
  }
}

TEST_F(Layer, TakesShadowsFromTheLampsOwnLight) {
  const Camera camera{{0.5, -4, 3}};
  Image buffer = analytic_buffer::buffer(camera, plane);
  make(buffer, camera);
  const std::vector<float> lit = channel("R");
  for (std::size_t n = 0; n < buffer.pixels.size(); n += buffer.channels.size())
    for (std::size_t k = kLamp; k < kLamp + 3; ++k) buffer.pixels[n + k] *= 0.25f;
  make(buffer, camera);
  const std::vector<float> shadowed = channel("R");
  for (std::size_t n = 0; n < lit.size(); ++n) ASSERT_NEAR(shadowed[n], 0.25 * lit[n], 1e-4 * lit[n]);
}

TEST_F(Layer, OfEachLampAddsUp) {
  const Camera camera{{0.5, -4, 3}};
  LayerSettings settings;
  settings.per_lamp = true;
  make(analytic_buffer::buffer(camera, plane), camera, settings);
  EXPECT_EQ(channel("bulb.G"), channel("G"));
}

TEST_F(Layer, SkipsAndCountsWhatIsNoNumber) {
  const Camera camera{{0.5, -4, 3}};
  Image buffer = analytic_buffer::buffer(camera, plane);
  const std::size_t middle = (18 * 48 + 24) * buffer.channels.size();
  buffer.pixels[middle + kUv] = std::nanf("");
  const LayerResult result = make(buffer, camera);
  EXPECT_EQ(result.counts.broken, 1u);
  for (const float value : channel("R")) ASSERT_TRUE(std::isfinite(value) && value >= 0);
  EXPECT_EQ(channel("R")[18 * 48 + 24], 0);
}

TEST_F(Layer, CountsPixelsWithoutNeighbours) {
  const Camera camera{{0.5, -4, 3}};
  Image buffer = analytic_buffer::buffer(camera, plane);
  for (int n = 0; n < 48 * 36; ++n)
    if (n != 18 * 48 + 24) buffer.pixels[static_cast<std::size_t>(n) * buffer.channels.size() + kId] = 0;
  const LayerResult result = make(buffer, camera);
  EXPECT_EQ(result.counts.covered, 1u);
  EXPECT_EQ(result.counts.alone, 1u);
}

/// Changes of uv a pixel, or those of the position a unit of uv, beside a buffer's channels.
Image with_derivatives(const Image& buffer, const Camera& camera, const Shape& shape, bool of_position) {
  constexpr double step = 1e-4;  // pixels, or uv of the sphere's and the plane's square
  Image image = buffer;
  image.pixels.clear();
  const std::vector<std::string> names =
      of_position ? std::vector<std::string>{"dp_du.X", "dp_du.Y", "dp_du.Z", "dp_dv.X", "dp_dv.Y", "dp_dv.Z"}
                  : std::vector<std::string>{"duv_dx.U", "duv_dx.V", "duv_dy.U", "duv_dy.V"};
  image.channels.insert(image.channels.end(), names.begin(), names.end());
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) {
      const auto* here =
          &buffer.pixels[static_cast<std::size_t>(row * camera.width + column) * buffer.channels.size()];
      image.pixels.insert(image.pixels.end(), here, here + buffer.channels.size());
      const auto at = [&](double down, double right) {
        return shape(camera.position, camera.direction(row, column) +
                                          camera.pixel() * (right * camera.right() - down * camera.up()));
      };
      const auto middle = at(0, 0), right = at(0, step), down = at(step, 0);
      if (!middle || !right || !down) {
        image.pixels.insert(image.pixels.end(), names.size(), std::nanf(""));
        continue;
      }
      Eigen::Matrix2d duv;
      duv << (right->uv - middle->uv) / step, (down->uv - middle->uv) / step;
      Eigen::Matrix<double, 3, 2> dp;
      dp << (right->position - middle->position) / step, (down->position - middle->position) / step;
      const Eigen::Matrix<double, 3, 2> dpduv = dp * duv.inverse();
      const double* first = of_position ? dpduv.data() : duv.data();
      for (std::size_t n = 0; n < names.size(); ++n) image.pixels.push_back(static_cast<float>(first[n]));
    }
  return image;
}

/// Every third pixel of every third row is all that there is of the surface.
void leave_some(Image* buffer) {
  for (int row = 0; row < buffer->height; ++row)
    for (int column = 0; column < buffer->width; ++column)
      if (row % 3 != 1 || column % 3 != 1)
        buffer
            ->pixels[static_cast<std::size_t>(row * buffer->width + column) * buffer->channels.size() + kId] =
            0;
}

TEST_F(Layer, OfPixelsAloneHasTheFootprintsOfDerivatives) {
  const Camera camera{{0.5, -4, 3}};
  const Image buffer = analytic_buffer::buffer(camera, plane);
  const std::vector<float> expected = channel(picture(job(camera, kPlane)), "ndf.Y");
  const float brightest = *std::max_element(expected.begin(), expected.end());
  LayerSettings settings;
  settings.aovs = {LayerAov::density};
  for (const bool of_position : {false, true}) {
    Image some = with_derivatives(buffer, camera, plane, of_position);
    leave_some(&some);
    const LayerResult result = make(some, camera, settings);
    EXPECT_GT(result.counts.covered, 100u);
    EXPECT_EQ(result.counts.alone, 0u);
    EXPECT_EQ(result.counts.one_sided, result.counts.covered);
    const std::vector<float> found = channel("D");
    double sum = 0;
    int pixels = 0;
    for (std::size_t n = 0; n < found.size(); ++n) {
      if (some.pixels[n * some.channels.size() + kId] != 1 || expected[n] <= 0.01f * brightest) continue;
      sum += std::abs(found[n] / expected[n] - 1), ++pixels;
    }
    EXPECT_GT(pixels, 20);
    EXPECT_LT(sum / pixels, 0.02) << of_position;
  }
}

TEST_F(Layer, TakesNeighboursWhereDerivativesAreNone) {
  const Camera camera{{0.5, -4, 3}};
  const Image buffer = analytic_buffer::buffer(camera, plane);
  make(buffer, camera);
  const std::vector<float> expected = channel("R");
  for (const bool of_position : {false, true}) {
    Image none = with_derivatives(buffer, camera, plane, of_position);
    for (std::size_t n = 0; n < none.pixels.size(); n += none.channels.size())
      for (std::size_t k = buffer.channels.size(); k < none.channels.size(); ++k)
        none.pixels[n + k] = n / none.channels.size() % 2 == 0 ? std::nanf("") : 0;
    make(none, camera);
    EXPECT_EQ(channel("R"), expected) << of_position;
  }
}

/// Every method answers, each with light that is a number and not all black.
TEST_F(Layer, TakesEveryMethod) {
  const Camera camera{{0.5, -4, 3}, 24, 24, 18};
  const Image buffer = analytic_buffer::buffer(camera, plane);
  for (const std::string& ndf :
       MethodRegistry::builtin().names([](const MethodTraits& traits) { return traits.jobs; })) {
    const std::string surface =
        MethodRegistry::builtin().get(ndf).traits().map ? "surface = \"bumps\", roughness = 0.1, " : "";
    make(buffer, camera, {}, 0,
         "surface.bumps = { generate = \"spectrum\", resolution = 64, rms_slope = 0.3, correlation = 8, seed "
         "= 1 }\n"
         "material.a = { " +
             surface + "ndf = \"" + ndf + "\", id = 1 }\n");
    double sum = 0;
    for (const float value : channel("R")) {
      ASSERT_TRUE(std::isfinite(value) && value >= 0) << ndf;
      sum += value;
    }
    EXPECT_GT(sum, 0) << ndf;
  }
}

}  // namespace
}  // namespace mica::host::layer_test
