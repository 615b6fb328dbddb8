// The audit of lights that are multiplied with a patch's BRDF, against its definition in double precision.
#include <gtest/gtest.h>

#include <fstream>

#include "host/job/job.h"
#include "host/render/render.h"
#include "tests/temporary_path.h"

namespace mica::host::brdf_audit_test {
namespace {

RenderResult render_job(const std::vector<std::string>& overrides) {
  const std::string path = temporary_path("brdf_audit_test.toml");
  std::ofstream(path) << R"(
image = { width = 32, height = 24, subpixels = 2 }
camera = { position = [0.0, -2.0, 3.0], look_at = [0.0, 0.0, 0.0], fov = 30 }
surface.bumps = { generate = "spectrum", resolution = 128, rms_slope = 0.3, correlation = 6 }
material.metal = { surface = "bumps", repeat = [8, 8], roughness = 0.03 }
shape = [{ type = "plane", material = "metal", size = 4 }]
light = [{ type = "point", position = [0.3, 2.0, 3.0], intensity = [9.0, 9.0, 9.0] },
         { type = "point", position = [-2.0, -1.0, 2.0], intensity = [9.0, 9.0, 9.0] }]
audit = { samples = 400 }
)";
  const Job job = load_job(path, overrides);
  Device device(0);
  return render(job, make_plan(job), device, [](int, int) {});
}

TEST(BrdfAudit, HoldsThemToTheirDefinition) {
  for (const std::string ndf : {"beckmanns", "cavities"}) {
    const RenderResult result = render_job({"material.metal.ndf=" + ndf});
    std::printf("%s: relative L2 %.2g, maximum %.2g\n", ndf.c_str(), result.audit.relative_l2,
                result.audit.maximum);
    EXPECT_EQ(result.audit.samples, 400U) << ndf;
    EXPECT_GT(result.audit.relative_l2, 0) << ndf;
    EXPECT_LT(result.audit.relative_l2, 1e-3) << ndf;
    EXPECT_NE(result.image.metadata.at("mica:audit").find("400 queries"), std::string::npos);
  }
}

TEST(BrdfAudit, CountsWhatMaskingApproximates) {
  const double exact = render_job({"material.metal.ndf=beckmanns"}).audit.relative_l2;
  const double geometric =
      render_job({"material.metal.ndf=beckmanns", "material.metal.masking=geometric"}).audit.relative_l2;
  EXPECT_GT(geometric, 20 * exact);
}

/// Baselines have no definition but their kernel: plans say that the audit does not see them.
TEST(BrdfAudit, LeavesOutBaselines) {
  const RenderResult result = render_job({"material.metal.ndf=normalmap"});
  EXPECT_EQ(result.audit.samples, 0U);
  ASSERT_EQ(result.plan.warnings.size(), 1U);
  EXPECT_NE(result.plan.warnings[0].find("[audit] sees nothing of material metal"), std::string::npos);
}

}  // namespace
}  // namespace mica::host::brdf_audit_test
