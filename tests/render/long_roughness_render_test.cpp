// A roughness of two numbers from the job to the picture, and who refuses it.
#include <gtest/gtest.h>

#include <fstream>

#include "host/base/error_norms.h"
#include "host/job/job.h"
#include "host/render/render.h"
#include "mica/error.h"
#include "tests/temporary_path.h"

namespace mica::host::long_roughness_render_test {
namespace {

/// A plane without bumps under a lamp: all that is seen is the lobe.
Job flat_job(const std::vector<std::string>& overrides) {
  const std::string path = temporary_path("long_roughness_render_test.toml");
  std::ofstream(path) << R"(
image = { width = 40, height = 30 }
camera = { position = [0.0, -2.0, 3.0], look_at = [0.0, 0.0, 0.0], fov = 30 }
surface.flat = { generate = "spectrum", resolution = 64, rms_slope = 1e-5, correlation = 8 }
material.metal = { surface = "flat", ndf = "triangles", roughness = [0.15, 0.05] }
shape = [{ type = "plane", material = "metal", size = 4 }]
light = [{ type = "point", position = [0.3, 2.0, 3.0], intensity = [9.0, 9.0, 9.0] }]
)";
  return load_job(path, overrides);
}

std::vector<float> picture(const std::vector<std::string>& overrides) {
  const Job job = flat_job(overrides);
  Device device(0);
  return render(job, make_plan(job), device, [](int, int) {}).image.pixels;
}

TEST(LongRoughnessOfAPicture, TurnsWithTheShape) {
  const std::string turned = "shape.0.rotate=[0, 0, 90]", swapped = "material.metal.roughness=[0.05, 0.15]";
  for (const std::string filter : {"image.filter=gaussian", "image.filter=subpixels"}) {
    const std::vector<float> expected = picture({filter});
    EXPECT_LT(relative_l2(picture({filter, turned, swapped}), expected), 1e-3) << filter;
    EXPECT_GT(relative_l2(picture({filter, swapped}), expected), 0.3) << filter;
    EXPECT_GT(relative_l2(picture({filter, "material.metal.roughness=0.111803398875"}), expected), 0.1)
        << filter << ": a round lobe of the same mean square";
  }
}

TEST(LongRoughnessOfAPicture, IsRefusedWhereLobesAreRound) {
  const auto problem = [](const std::vector<std::string>& overrides) -> std::string {
    try {
      make_plan(flat_job(overrides));
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(problem({}), "");
  EXPECT_EQ(problem({"material.metal.ndf=gaussians"}), "");
  for (const std::string ndf : {"beckmanns", "cavities", "normalmap"})
    EXPECT_NE(problem({"material.metal.ndf=" + ndf}).find("material.metal.roughness: found 2 numbers"),
              std::string::npos)
        << ndf;
  EXPECT_NE(problem({"image.max_bounces=2"}).find("found 2 numbers beside light from all around"),
            std::string::npos);
  EXPECT_EQ(problem({"image.max_bounces=2", "material.metal.roughness=[0.1, 0.1]"}), "");
}

}  // namespace
}  // namespace mica::host::long_roughness_render_test
