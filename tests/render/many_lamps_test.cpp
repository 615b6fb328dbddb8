// Pictures of many lamps, of which each has edges elsewhere, against the sum of the pictures of each lamp.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <string>
#include <vector>

#include "host/base/error_norms.h"
#include "host/base/random.h"
#include "host/job/job.h"
#include "host/render/built_job.h"
#include "host/render/render.h"
#include "tests/temporary_path.h"

namespace mica::host::many_lamps_test {
namespace {

constexpr int kSide = 24;
using Place = std::array<double, 3>;

/// A bowl, whose rim throws shadows on what is behind it.
std::string job_of(const std::vector<Place>& lamps) {
  const std::string path = temporary_path("many_lamps_test.toml");
  std::ofstream file(path);
  file << R"(
image = { width = 24, height = 24, subpixels = 4 }
camera = { position = [0, -3.2, 1.4], look_at = [0, 0, 0.45], fov = 9 }
surface.m = { generate = "spectrum", resolution = 256, rms_slope = 0.3, correlation = 8, seed = 1 }
material.a = { surface = "m", ndf = "triangles", repeat = [2, 2], roughness = 0.02, diffuse = [0.2, 0.1, 0.3] }
shape = [{ type = "shell", material = "a" }]
)";
  for (const Place& p : lamps)
    file << "[[light]]\ntype = \"point\"\nintensity = [5, 4, 3]\nposition = [" << p[0] << ", " << p[1] << ", "
         << p[2] << "]\n";
  return path;
}

RenderResult render_job(const std::vector<Place>& lamps, int rows_a_block = kSide) {
  const Job job = load_job(job_of(lamps), {});
  Plan plan = make_plan(job);
  plan.rows_a_block = rows_a_block;
  Device device(0);
  return render(job, plan, device, [](int, int) {});
}

std::vector<Place> places(int count) {
  std::vector<Place> lamps;
  const auto random = [](int n, std::uint64_t axis) {
    return random_unit(1, 2, 3 * static_cast<std::uint64_t>(n) + axis);
  };
  for (int n = 0; n < count; ++n)
    lamps.push_back({6 * random(n, 0) - 3, -4 + 3 * random(n, 1), 1 + 3 * random(n, 2)});
  return lamps;
}

std::vector<float> sum(std::vector<float> a, const std::vector<float>& b) {
  for (std::size_t n = 0; n < a.size(); ++n) a[n] += b[n];
  return a;
}

std::vector<float> sum_of_pictures(const std::vector<Place>& lamps) {
  std::vector<float> all(3 * kSide * kSide, 0.0f);
  for (const Place& lamp : lamps) all = sum(all, render_job({lamp}).image.pixels);
  return all;
}

/// Pixels that are fitted but for some lamps.
std::size_t mixed_pixels(const std::vector<Place>& lamps) {
  const Job job = load_job(job_of(lamps), {});
  const Plan plan = make_plan(job);
  Device device(0);
  const BuiltJob built(job, plan, device);
  std::size_t count = 0;
  for (const auto& sampled : built.trace(0, kSide).sampled_lamps) count += sampled.empty() ? 0 : 1;
  return count;
}

TEST(ManyLamps, AreTheSumOfEach) {
  const std::vector<Place> lamps = places(12);
  const RenderResult together = render_job(lamps);
  const double off = relative_l2(together.image.pixels, sum_of_pictures(lamps));
  std::printf("12 lamps: relative L2 %.4f, %zu queries\n", off, together.queries);
  EXPECT_LT(off, 0.01);
  EXPECT_GT(mixed_pixels(lamps), 20U) << "a scene without edges of some lamps";
}

TEST(ManyLamps, DoNotDependOnBlocks) {
  const std::vector<Place> lamps = places(8);
  const RenderResult whole = render_job(lamps);
  for (const int rows : {1, 7}) EXPECT_EQ(render_job(lamps, rows).image.pixels, whole.image.pixels) << rows;
}

}  // namespace
}  // namespace mica::host::many_lamps_test
