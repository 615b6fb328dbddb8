#include "host/render/render.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "host/job/job.h"
#include "host/render/built_job.h"
#include "tests/temporary_path.h"

namespace mica::host::render_test {
namespace {

/// A small picture of a sphere of polished metal, with every AOV.
std::string sphere_job(const std::string& light) {
  const std::string path = temporary_path("render_test.toml");
  std::ofstream(path) << R"(
[image]
width = 96
height = 72
subpixels = 2
filter = "subpixels"
aovs = ["ndf", "uv", "footprint", "normal", "queries"]
[camera]
position = [0.0, -4.0, 1.0]
look_at = [0.0, 0.0, 0.0]
fov = 30
[surface.noise]
generate = "spectrum"
resolution = 256
rms_slope = 0.15
correlation = 8
[surface.unused]
generate = "flakes"
resolution = 4096
[material.metal]
surface = "noise"
repeat = [8, 4]
ndf = "triangles"
roughness = 0.01
diffuse = [0.1, 0.2, 0.3]
[material.unused]
surface = "unused"
[[shape]]
type = "sphere"
material = "metal"
[[light]]
type = "directional"
direction = )" << light
                      << "\nirradiance = [3.0, 3.0, 3.0]\n[audit]\nsamples = 64\n";
  return path;
}

/// Direction in which light travels, from an azimuth about z in degrees.
std::string light_from(double azimuth_degrees) {
  const double a = azimuth_degrees * 3.14159265358979 / 180;
  char text[100];
  std::snprintf(text, sizeof text, "[%.9f, %.9f, -0.8]", std::sin(a), std::cos(a));
  return text;
}

RenderResult render_job(const std::string& path, int rows_a_block = 0, int surface_seed = 1) {
  const Job job = load_job(path, {"surface.noise.seed=" + std::to_string(surface_seed)});
  Plan plan = make_plan(job);
  if (rows_a_block) plan.rows_a_block = rows_a_block;
  Device device(0);
  return render(job, plan, device, [](int, int) {});
}

TEST(Render, IsTheSameForAnyBlockSizeAndThreadCount) {
  const std::string job = sphere_job(light_from(-30));
  const RenderResult whole = render_job(job, 72), rows = render_job(job, 5);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const RenderResult alone = render_job(job, 72);
  EXPECT_EQ(whole.image.pixels, rows.image.pixels);
  EXPECT_EQ(whole.image.pixels, alone.image.pixels);
  EXPECT_EQ(whole.image.metadata.at("mica:audit"), rows.image.metadata.at("mica:audit"));
}

TEST(Render, KeepsItsErrorAndSaysSo) {
  const RenderResult result = render_job(sphere_job(light_from(-30)));
  EXPECT_EQ(result.audit.samples, 64u);
  EXPECT_LT(result.audit.maximum, 1e-4);
  EXPECT_LT(result.audit.relative_l2, 1e-4);
  for (const float value : result.image.pixels) ASSERT_TRUE(std::isfinite(value));
}

TEST(Render, BuildsOnlyWhatTheSceneUses) {
  const RenderResult result = render_job(sphere_job(light_from(-30)));
  ASSERT_EQ(result.plan.evaluators.size(), 1u);
  EXPECT_EQ(result.plan.evaluators[0].surface, "noise");
  EXPECT_EQ(result.plan.evaluator_of_material, (std::vector<int>{0, -1}));
  EXPECT_EQ(result.plan.evaluators[0].device_bytes, result.device_bytes);
}

/// Glints of an image: log density less its mean over 5x5 pixels, so that the highlight's shape does not
/// count, where all subpixels see the sphere.
std::vector<double> glints(const Image& image) {
  const auto channel = [&](const char* name) {
    return std::find(image.channels.begin(), image.channels.end(), name) - image.channels.begin();
  };
  const auto value = [&](const char* name, int x, int y) {
    return image
        .pixels[(static_cast<std::size_t>(y) * image.width + x) * image.channels.size() + channel(name)];
  };
  std::vector<double> result;
  for (int y = 2; y < image.height - 2; ++y) {
    for (int x = 2; x < image.width - 2; ++x) {
      double mean = 0;
      bool inside = true;
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          mean += std::log1p(value("ndf.Y", x + dx, y + dy)) / 25;
          inside &= value("queries.Y", x + dx, y + dy) == 4;
        }
      }
      result.push_back(inside ? std::log1p(value("ndf.Y", x, y)) - mean : 0);
    }
  }
  return result;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t n = 0; n < a.size(); ++n) ab += a[n] * b[n], aa += a[n] * a[n], bb += b[n] * b[n];
  return ab / std::sqrt(aa * bb);
}

// Moving the light by a tenth of a degree moves glints; it does not reshuffle them: neighbouring frames
// resemble each other, pictures of two maps of the same statistics do not.
TEST(Render, GlintsAreCoherentInTime) {
  const auto frame = [](double azimuth, int surface_seed) {
    return glints(render_job(sphere_job(light_from(azimuth)), 0, surface_seed).image);
  };
  const std::vector<double> first = frame(-30, 1), next = frame(-30.1, 1), other = frame(-30, 2);
  const double neighbours = correlation(first, next), independent = correlation(first, other);
  RecordProperty("neighbours", std::to_string(neighbours));
  RecordProperty("independent", std::to_string(independent));
  EXPECT_GT(neighbours, 0.95);
  EXPECT_LT(independent, 0.3);
}

/// A plane under one lamp, looked at along its normal.
std::string plane_job(const std::string& lamp_height, const std::string& more = "") {
  const std::string path = temporary_path("render_plane_test.toml");
  std::ofstream(path) << R"(
image = { width = 1, height = 1, subpixels = 1, filter = "subpixels" }
camera = { position = [0, -0.001, 3], look_at = [0, 0, 0], fov = 1 }
surface.bumps = { generate = "spectrum", resolution = 32, rms_slope = 0.3, correlation = 4 }
material.gold = { surface = "bumps", ndf = "triangles", roughness = 0.1, diffuse = [0.1, 0.07, 0.02] }
shape = [{ type = "plane", material = "gold" }]
light = [{ type = "point", position = [0, 0, )"
                      << lamp_height << "], intensity = [1e9, 1e9, 1e9] }]\n"
                      << more;
  return path;
}

bool all_finite(const Image& image) {
  return std::all_of(image.pixels.begin(), image.pixels.end(), [](float x) { return std::isfinite(x); });
}

/// The light of a lamp that all but touches a surface is more than numbers of a picture hold.
TEST(Render, CountsWhatAPictureCannotHold) {
  const Job job = load_job(plane_job("1e-20"), {});
  const Plan plan = make_plan(job);
  Device device(0);
  const RenderResult result = render(job, plan, device, [](int, int) {});
  EXPECT_TRUE(all_finite(result.image));
  EXPECT_GT(result.repairs.not_finite, 0u);
  EXPECT_EQ(result.surface_warnings.size(), 1u);
  const Job far_job = load_job(plane_job("1"), {});
  const RenderResult far = render(far_job, plan, device, [](int, int) {});
  EXPECT_TRUE(all_finite(far.image));
  EXPECT_EQ(far.repairs.not_finite, 0u);
  EXPECT_TRUE(far.surface_warnings.empty());
}

/// A frame by `auto` is the same whichever others are rendered: on a surface that moves, and on one that does
/// not while the camera comes near.
TEST(Render, AutoFramesDependOnTheirNumberAlone) {
  const std::string path = temporary_path("render_auto_test.toml");
  std::ofstream(path) << R"(
image = { width = 16, height = 16, subpixels = 3, filter = "subpixels" }
camera = { keys = [{ frame = 0, position = [0, -40, 20] }, { frame = 2, position = [0, -0.5, 0.3] }] }
surface.w = { generate = "waves", resolution = 16, patch = 50 }
surface.f = { generate = "flakes", resolution = 64 }
material.a = { surface = "w", roughness = 0.02, ndf = "auto", repeat = [2, 2] }
material.b = { surface = "f", roughness = 0.02, ndf = "auto", repeat = [4, 4] }
shape = [{ type = "plane", size = 3, material = "a" }, { type = "plane", size = 3, center = [3, 0, 0], material = "b" }]
light = [{ type = "sphere", position = [0.3, 3, 4] }]
frames = { range = [0, 2] }
accuracy = { tolerance = 0.5 }
)";
  const Job job = load_job(path, {});
  const Plan plan = make_plan(job);
  Device device(0);
  const auto render_at = [&](BuiltJob& built, int frame) {
    return render_frame(built, frame, device.info(), [](int, int) {});
  };
  BuiltJob built(job, plan, device);
  std::vector<RenderResult> sequence;
  for (int frame = 0; frame <= 2; ++frame) sequence.push_back(render_at(built, frame));
  for (const int frame : {1, 2}) {
    BuiltJob alone(job, plan, device, frame);
    EXPECT_EQ(render_at(alone, frame).image.pixels, sequence[static_cast<std::size_t>(frame)].image.pixels)
        << frame;
  }
  // What is noted of a surface is noted of this frame's, not of all before it.
  EXPECT_LE(sequence[2].surface_notes.size(), sequence[0].surface_notes.size() + 2);
}

}  // namespace
}  // namespace mica::host::render_test
