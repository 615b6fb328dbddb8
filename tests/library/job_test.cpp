#include "mica/job.h"

#include <gtest/gtest.h>

#include "mica/error.h"

namespace mica::job_test {
namespace {

const char* const kJob = R"(
  image = { width = 24, height = 16, subpixels = 1, aovs = ["ndf"] }
  camera = { position = [0, -3.2, 1.4], look_at = [0, 0, 0.45], fov = 24 }
  surface.bumps = { generate = "spectrum", resolution = 64, rms_slope = 0.3, correlation = 8, seed = 1 }
  material.gold = { surface = "bumps", repeat = [6, 6], specular = { color = [1, 0.8, 0.4] } }
  shape = [{ type = "shell", material = "gold" }]
  light = [{ type = "point", position = [1.6, -3.6, 3.4], intensity = [25, 25, 25] }]
)";

TEST(LibraryJob, RendersToNamedChannels) {
  const Job job = Job::parse(kJob);
  EXPECT_NE(job.plan().find("auto on surface bumps"), std::string::npos);
  const Renderer renderer(Device(), job);
  std::size_t rows = 0;
  RunControl control;
  control.progress = [&](std::size_t done, std::size_t all) {
    rows = done;
    EXPECT_EQ(all, 16u);
  };
  const Image image = renderer.render(control);
  EXPECT_EQ(rows, 16u);
  EXPECT_EQ(image.width * image.height, 24 * 16);
  EXPECT_EQ(image.channel("ndf.Y").size(), 24u * 16);
  EXPECT_EQ(image.metadata.at("mica:version"), version());
  EXPECT_THROW(image.channel("Z"), UsageError);
  EXPECT_EQ(renderer.render().pixels, image.pixels) << "the same bits again";
  EXPECT_THROW(renderer.render(5), UsageError);
}

TEST(LibraryJob, IsRefusedWithEverythingThatIsWrong) {
  try {
    Job::parse("image = { width = -3 }\nshape = 7\n");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("width"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("shape"), std::string::npos);
  }
  EXPECT_THROW(Job::load("/nowhere/job.toml"), FileError);
  EXPECT_THROW(Job::parse(kJob, ".", {"material.gold.ndf=\"triangle\""}), UsageError);
}

TEST(LibraryJob, StopsWhenItIsCancelled) {
  RunControl control;
  control.cancellation.cancel();
  EXPECT_THROW(Renderer(Device(), Job::parse(kJob)).render(control), Cancelled);
}

TEST(LibraryImage, KnowsHowItsJobShowsIt) {
  const Image image =
      Renderer(Device(), Job::parse(kJob, ".", {"image.exposure=2", "image.tone_map=\"filmic\""})).render();
  EXPECT_EQ(image.exposure_stops, 2);
  EXPECT_EQ(image.tone_map, "filmic");
}

TEST(LibraryImage, IsNotWrittenUnlessItIsWhole) {
  Image image;
  image.width = 2, image.height = 2, image.channels = {"R", "G", "B"};
  EXPECT_THROW(write(image, "x.exr"), UsageError);
  image.pixels.assign(12, 1.0F);
  EXPECT_THROW(write(image, "x.jpg"), UsageError);
  EXPECT_THROW(write(image, "/nowhere/x.exr"), FileError);
  image.tone_map = "sepia";
  EXPECT_THROW(write(image, "x.png"), UsageError);
}

}  // namespace
}  // namespace mica::job_test
