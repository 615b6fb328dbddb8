#include <algorithm>

#include "tests/job/job_text.h"

namespace mica::host::test::pictures_test {
namespace {

TEST(Pictures, AreChosenAndRepairedAsTheJobSays) {
  const JobFolder folder;
  folder.write("a.exr", "");
  const std::string keys = "part = \"beauty\"\nchannels = \"sky\"\n";
  folder.write("job.toml",
               kLeastJob + "[surface.map]\nfile = \"a.exr\"\n" + keys +
                   "[[light]]\ntype = \"environment\"\nimage = \"a.exr\"\ninvalid = \"refuse\"\n" + keys +
                   "[background]\nimage = \"a.exr\"\n" + keys);
  const Job job = load_job(folder.path("job.toml"), {}, MethodRegistry::builtin(), 1 << 20);
  const auto map = std::find_if(job.surfaces.begin(), job.surfaces.end(),
                                [](const SurfaceDescription& surface) { return surface.name == "map"; });
  ASSERT_NE(map, job.surfaces.end());
  const EnvironmentLight& light = job.scene.environments.at(0);
  for (const PictureChoice& choice :
       {std::get<MapFile>(map->source).choice, light.choice, job.scene.background.choice}) {
    EXPECT_EQ(choice.part, "beauty");
    EXPECT_EQ(choice.channels, "sky");
    EXPECT_EQ(choice.max_bytes, 1u << 20);
  }
  EXPECT_EQ(light.invalid, TexelRepair::refuse);
  EXPECT_EQ(job.scene.background.invalid, TexelRepair::repair);
}

}  // namespace
}  // namespace mica::host::test::pictures_test
