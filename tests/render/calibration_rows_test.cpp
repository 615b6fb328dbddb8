// What a method that chooses looks at: blocks of the picture, which are traced once.
#include "host/render/calibration_rows.h"

#include <gtest/gtest.h>

#include <fstream>

#include "host/render/built_job.h"
#include "host/render/plan.h"
#include "tests/temporary_path.h"

namespace mica::host::calibration_rows_test {
namespace {

/// 96 x 80 pixels of a ball, in five blocks.
struct Picture {
  explicit Picture(const std::vector<std::string>& overrides = {})
      : job(load_job(file(), overrides)), plan(make_plan(job)) {
    plan.rows_a_block = 16;
  }
  static std::string file() {
    const std::string path = temporary_path("calibration_rows_test.toml");
    std::ofstream(path) << R"(
image = { width = 96, height = 80 }
camera = { position = [0, -4, 1], look_at = [0, 0, 0], fov = 30 }
surface.m = { generate = "spectrum", resolution = 256, rms_slope = 0.2 }
material.a = { surface = "m", repeat = [8, 4], roughness = 0.03 }
shape = [{ type = "sphere", material = "a" }]
light = [{ type = "point", position = [3, -4, 4], intensity = [30, 30, 30] }]
)";
    return path;
  }

  Job job;
  Plan plan;
};

void expect_same(const TracedRows& a, const TracedRows& b) {
  ASSERT_EQ(a.queries.size(), b.queries.size());
  for (std::size_t n = 0; n < a.queries.size(); ++n) {
    EXPECT_EQ(a.queries[n].pixel, b.queries[n].pixel);
    EXPECT_EQ(a.queries[n].query.half_vector, b.queries[n].query.half_vector);
    EXPECT_EQ(a.queries[n].query.footprint.mean_uv, b.queries[n].query.footprint.mean_uv);
    EXPECT_EQ(a.queries[n].weight, b.queries[n].weight);
  }
  EXPECT_EQ(a.fitted, b.fitted);
}

TEST(CalibrationRows, AreTracedOnceAndTheSameAsOthers) {
  const Picture picture;
  Device device(0);
  int traced = 0;
  BuiltJob built(picture.job, picture.plan, device, 0, [&](const Scene& scene, int first, int count) {
    ++traced;
    return scene.trace(first, count);
  });
  EXPECT_EQ(traced, kMostBlocksLookedAt);
  for (int first = 0; first < 80; first += 16)
    expect_same(built.take_rows(first, 16), built.scene().trace(first, 16));
  EXPECT_EQ(traced, 5);
  built.take_rows(16, 16);
  EXPECT_EQ(traced, 6);  // what was taken is gone
  built.take_rows(15, 16);
  EXPECT_EQ(traced, 7);
}

/// As many queries as the picture asks, within what three blocks of five can tell of a ball.
TEST(CalibrationRows, StandForAllOfThePicture) {
  const Picture picture;
  Device device(0);
  const BuiltJob built(picture.job, picture.plan, device);
  const auto scene_at = [&](int) {
    return built.scene().with_view(picture.job.scene.camera, built.scene().lights(), {},
                                   built.scene().pixels());
  };
  const auto trace = [](const Scene& scene, int first, int count) { return scene.trace(first, count); };
  const SomeQueries some = queries_of_some_rows(picture.plan, 80, {0, 1}, scene_at, trace);
  ASSERT_EQ(some.of_evaluator.size(), 1u);
  EXPECT_NEAR(some.scale * static_cast<double>(some.of_evaluator[0].size()),
              static_cast<double>(built.trace(0, 80).queries.size()),
              0.2 * built.trace(0, 80).queries.size());
  const SomeQueries of_frames = queries_of_some_rows(picture.plan, 80, {0, 30}, scene_at, trace);
  EXPECT_TRUE(of_frames.blocks.empty());
  EXPECT_NEAR(of_frames.scale * static_cast<double>(of_frames.of_evaluator[0].size()),
              30.0 * built.trace(0, 80).queries.size(), 6.0 * built.trace(0, 80).queries.size());
}

}  // namespace
}  // namespace mica::host::calibration_rows_test
