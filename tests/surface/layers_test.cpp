#include "host/surface/map_size.h"
#include "mica/error.h"
#include "tests/surface/map_statistics.h"

namespace mica::host::layers_test {
namespace {

SurfaceDescription brushed(int resolution) {
  BrushedSurface description;
  description.resolution = resolution, description.correlation_along_texels = 16;
  return {"brushed", description, Interpolation::bilinear};
}

SurfaceDescription dents(int resolution) {
  DentsSurface description;
  description.resolution = resolution, description.radius_high_texels = 16;
  return {"dents", description, Interpolation::bilinear};
}

SurfaceDescription sum(std::vector<SurfaceLayer> layers) {
  return {"worn", LayersSurface{std::move(layers)}, Interpolation::bicubic};
}

TEST(Layers, AddSlopesByWeight) {
  const Surface worn = make_surface(sum({{brushed(64), 1.5}, {dents(64), -0.5}}), nullptr);
  const Slopes slopes = slopes_of(worn.normals());
  const Slopes a = slopes_of(make_surface(brushed(64), nullptr).normals());
  const Slopes b = slopes_of(make_surface(dents(64), nullptr).normals());
  for (std::size_t n = 0; n < slopes.size(); ++n)
    ASSERT_LT((slopes[n] - (1.5 * a[n] - 0.5 * b[n])).norm(), 1e-12);
  EXPECT_EQ(worn.interpolation(), Interpolation::bicubic);
}

TEST(Layers, HaveTheSizeOfTheirFirst) {
  const MapSize size = map_size(sum({{brushed(48), 1}, {dents(48), 1}}));
  EXPECT_EQ(size.width, 48);
  EXPECT_EQ(size.height, 48);
}

TEST(Layers, RefuseWhatCannotBeAdded) {
  EXPECT_THROW(make_surface(sum({}), nullptr), UsageError);
  EXPECT_THROW(make_surface(sum({{brushed(64), 1}, {dents(128), 1}}), nullptr), UsageError);
  EXPECT_THROW(make_surface(sum({{brushed(64), std::nan("")}}), nullptr), UsageError);
}

TEST(Layers, DoNotDependOnTheNumberOfThreads) {
  expect_same_on_any_threads([] {
    return make_surface(sum({{brushed(64), 1}, {dents(64), 0.5}}), nullptr).normals();
  });
}

}  // namespace
}  // namespace mica::host::layers_test
