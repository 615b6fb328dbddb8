// Frames and keyframes of a job.
#include "tests/job/job_text.h"

namespace mica::host::test::frames_test {
namespace {

struct FramesOfAJob : testing::Test {
  JobFolder folder;
  std::string message_of(const std::string& text) const {
    const auto issues = folder.issues(text);
    return issues.size() == 1 ? issues[0].message : std::to_string(issues.size()) + " issues";
  }
};

TEST_F(FramesOfAJob, AreOneUnlessSaid) {
  const Job job = folder.load(kLeastJob);
  EXPECT_FALSE(job.frames.given);
  EXPECT_EQ(job.frames.first, 0);
  EXPECT_EQ(job.frames.last, 0);
}

TEST_F(FramesOfAJob, AreRead) {
  const Job job =
      folder.load(kLeastJob +
                  "keys = [{ frame = 3, position = [1, 2, 3] }, { frame = 7.5, intensity = [1, 1, 1] }]\n"
                  "[frames]\nrange = [3, 9]\nrate = 30\n"
                  "[camera]\nfov = 33\nkeys = [{ frame = 0 }, { frame = 9, fov = 44 }]\n");
  EXPECT_TRUE(job.frames.given);
  EXPECT_EQ(job.frames.first, 3);
  EXPECT_EQ(job.frames.last, 9);
  EXPECT_EQ(job.frames.seconds(15), 0.5);
  const auto& keys = job.scene.light_keys.at(0);
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(keys[1].frame, 7.5);
  EXPECT_EQ(std::get<PointLight>(keys[0].value).position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(std::get<PointLight>(keys[1].value).position, Eigen::Vector3d(0, 0, 4));  // the light's own
  ASSERT_EQ(job.scene.camera_keys.size(), 2u);
  EXPECT_EQ(job.scene.camera_keys[0].value.fov_degrees, 33);
  EXPECT_EQ(job.scene.camera_keys[1].value.fov_degrees, 44);
}

TEST_F(FramesOfAJob, RefuseWhatMakesNoSense) {
  EXPECT_EQ(message_of(kLeastJob + "[frames]\nrate = 3\n").rfind("frames: found no key \"range\"", 0), 0u);
  EXPECT_EQ(message_of(kLeastJob + "[frames]\nrange = [4, 3]\n").rfind("frames.range: found [4, 3]", 0), 0u);
  EXPECT_EQ(message_of(kLeastJob + "[frames]\nrange = [0, 1.5]\n").rfind("frames.range: found [0, 1.5]", 0),
            0u);
  EXPECT_EQ(message_of(kLeastJob + "keys = [{ frame = 3 }, { frame = 3 }]\n")
                .rfind("light.0.keys.1.frame: found 3 after 3", 0),
            0u);
  EXPECT_EQ(message_of(kLeastJob + "keys = [{ position = [0, 0, 1] }]\n")
                .rfind("light.0.keys.0: found no key \"frame\"", 0),
            0u);
  EXPECT_EQ(message_of(kLeastJob + "keys = [{ frame = 0, color = 1 }]\n")
                .rfind("light.0.keys.0.color: found an unknown key", 0),
            0u);
}

TEST_F(FramesOfAJob, ToneMapsHaveNames) {
  EXPECT_EQ(folder.load("image = { tone_map = \"filmic\" }\n" + kLeastJob).image.tone_map, ToneMap::filmic);
  EXPECT_EQ(folder.load(kLeastJob).image.tone_map, ToneMap::shoulder);
  EXPECT_EQ(
      message_of("image = { tone_map = \"film\" }\n" + kLeastJob).rfind("image.tone_map: found \"film\"", 0),
      0u);
}

}  // namespace
}  // namespace mica::host::test::frames_test
