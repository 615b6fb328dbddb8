// Bad input of `mica glints`: each has its exit code and a message that helps, and leaves no file.
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <regex>

#include "mica/error.h"
#include "mica/glints.h"
#include "tests/app/command.h"
#include "tests/gbuffer/analytic_buffer.h"

namespace mica::host::app::glints_refusals_test {
namespace {

using namespace analytic_buffer;

constexpr int kUsage = 2, kFile = 4;

class Glints : public CommandTest {
 protected:
  Glints() : buffer_(analytic_buffer::buffer(camera_, plane)) {
    write("scene.toml", materials());
    write("g.json", view(camera_));
  }
  void write_buffer() const { write_exr(path("g.exr"), buffer_); }
  void expect_refusal(int code, const std::string& message, const std::string& arguments = "") const {
    const Outcome outcome = mica("glints g.exr --scene scene.toml -o layer.exr " + arguments);
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
    for (const std::string& file : files()) EXPECT_EQ(file.find("layer"), std::string::npos) << file;
  }
  float& value(int row, int column, std::size_t channel) {
    return buffer_
        .pixels[static_cast<std::size_t>(row * camera_.width + column) * buffer_.channels.size() + channel];
  }
  void rename(const std::string& from, const std::string& to) {
    for (std::string& channel : buffer_.channels) channel = std::regex_replace(channel, std::regex(from), to);
  }
  /// A buffer's parts as Blender 5 writes them, one a layer.
  void write_parts(OIIO::TypeDesc uv_type) const {
    std::vector<OIIO::ImageSpec> specs;
    std::vector<std::vector<float>> pixels;
    for (std::size_t n = 0; n < buffer_.channels.size(); ++n) {
      const std::string name = buffer_.channels[n].substr(0, buffer_.channels[n].rfind('.'));
      if (specs.empty() || specs.back().get_string_attribute("oiio:subimagename") != name) {
        specs.emplace_back(camera_.width, camera_.height, 0,
                           name == "ViewLayer.UV" ? uv_type : OIIO::TypeDesc::FLOAT);
        specs.back().attribute("oiio:subimagename", name);
        pixels.emplace_back();
      }
      specs.back().channelnames.push_back(buffer_.channels[n]);
      ++specs.back().nchannels;
    }
    std::size_t first = 0;
    for (std::size_t part = 0; part < specs.size(); ++part) {
      const auto count = static_cast<std::size_t>(specs[part].nchannels);
      for (std::size_t n = 0; n < buffer_.pixels.size(); n += buffer_.channels.size())
        for (std::size_t k = 0; k < count; ++k) pixels[part].push_back(buffer_.pixels[n + first + k]);
      first += count;
    }
    const auto output = OIIO::ImageOutput::create("openexr");
    ASSERT_TRUE(output->open(path("g.exr"), static_cast<int>(specs.size()), specs.data()))
        << output->geterror();
    for (std::size_t part = 0; part < specs.size(); ++part) {
      if (part > 0) {
        ASSERT_TRUE(output->open(path("g.exr"), specs[part], OIIO::ImageOutput::AppendSubimage));
      }
      ASSERT_TRUE(output->write_image(OIIO::TypeFloat, pixels[part].data()));
    }
    ASSERT_TRUE(output->close());
  }

  const Camera camera_{{0.5, -4, 3}};
  Image buffer_;
};

TEST_F(Glints, ReadPartsAsOnePart) {
  write_buffer();
  ASSERT_EQ(mica("glints g.exr --scene scene.toml -o one.exr --quiet").code, 0);
  write_parts(OIIO::TypeDesc::FLOAT);
  const Outcome outcome =
      mica("glints g.exr --scene scene.toml -o many.exr --preset blender5 --json many.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Image one = read_rgb(path("one.exr")), many = read_rgb(path("many.exr"));
  EXPECT_EQ(one.pixels, many.pixels);
  EXPECT_NE(bytes(path("many.json")).find("\"covered\": "), std::string::npos);
}

TEST_F(Glints, AreThoseOfTheLibrary) {
  write_buffer();
  const Outcome outcome = mica(
      "glints g.exr --scene scene.toml -o command.exr --scale 2 --aovs D,coverage --per-lamp --filter-width "
      "0.6");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  GlintSettings settings;
  settings.scale = 2, settings.filter_width = 0.6, settings.per_lamp = true;
  settings.aovs = {"D", "coverage"};
  const auto written = [&](const std::string& buffer) {
    return write_glints(mica::Device(), path(buffer), path("scene.toml"), path("layer.exr"), settings);
  };
  const GlintLayer layer = written("g.exr");
  EXPECT_EQ(bytes(path("layer.exr")), bytes(path("command.exr")));
  EXPECT_EQ(layer.channels,
            (std::vector<std::string>{"R", "G", "B", "A", "D", "coverage", "bulb.R", "bulb.G", "bulb.B"}));
  EXPECT_GT(layer.covered, layer.one_sided);
  EXPECT_GT(layer.queries, 0u);
  settings.filter = "tent";
  EXPECT_THROW(written("g.exr"), UsageError);
  settings.filter = "box", settings.filter_width = std::nan("");
  EXPECT_THROW(written("g.exr"), UsageError);
  settings.filter_width = 0, settings.scale = 0;
  EXPECT_THROW(written("g.exr"), UsageError);
  settings.scale = 1;
  EXPECT_THROW(written("none.exr"), FileError);
  const std::string before = bytes(path("g.exr"));
  EXPECT_THROW(write_glints(mica::Device(), path("g.exr"), path("scene.toml"), path("g.exr")), UsageError);
  EXPECT_EQ(bytes(path("g.exr")), before);
}

TEST_F(Glints, RefuseHalfFloats) {
  write_parts(OIIO::TypeDesc::HALF);
  expect_refusal(kFile, "ViewLayer.UV.U has 16 bits");
}

TEST_F(Glints, NameMissingChannels) {
  rename("UV", "somewhere");
  write_buffer();
  expect_refusal(kFile, "found no channels for uv; looked for UV, uv");
  expect_refusal(kFile, "found no channels for uv; looked for nowhere", "--channel uv=nowhere");
  EXPECT_EQ(mica("glints g.exr --scene scene.toml -o ok.exr --channel uv=ViewLayer.somewhere").code, 0);
  EXPECT_EQ(mica("glints g.exr --scene scene.toml -o ok.exr --channel uv=somewhere.U,somewhere.V").code, 0);
  expect_refusal(kUsage, "expected ROLE=NAME", "--channel colour=R");
}

TEST_F(Glints, RefuseFilteredBuffers) {
  value(20, 20, kId) = 0.5f;
  write_buffer();
  expect_refusal(kFile, "pixel (20, 20) from the top left has the id 0.5, which is no whole number");
  value(20, 20, kId) = 1;
  value(20, 20, 5) = 0.9f;  // the normal's z
  write_buffer();
  expect_refusal(kFile, "has a normal of length 0.9");
}

TEST_F(Glints, NameIdsWithoutAMaterial) {
  value(20, 20, kId) = 7;
  write_buffer();
  expect_refusal(kFile, "7 (1 pixels); no material has `id = 7`");
  EXPECT_EQ(mica("glints g.exr --scene scene.toml -o ok.exr --other-ids skip").code, 0);
}

TEST_F(Glints, RefuseAnotherCamera) {
  Camera other = camera_;
  other.width = 50;
  write_buffer();
  write("g.json", view(other));
  expect_refusal(kFile, "has 48 x 36 pixels, and its camera 50 x 36");
  other = camera_;
  other.fov_degrees = 30;
  write("g.json", view(other));
  expect_refusal(kFile, "expected the camera that made the G-buffer");
}

TEST_F(Glints, RefuseDamagedFiles) {
  write_buffer();
  const std::string whole = bytes(path("g.exr"));
  for (const std::size_t size : {whole.size() / 2, whole.size() - 10, std::size_t{200}, std::size_t{3}}) {
    write("g.exr", whole.substr(0, size));
    expect_refusal(kFile, "g.exr");
  }
  write("g.exr", "no picture");
  expect_refusal(kFile, "is not an image");
}

TEST_F(Glints, RefuseScenesWithoutIds) {
  write_buffer();
  write("scene.toml", std::regex_replace(materials(), std::regex(", id = 1"), ""));
  expect_refusal(kUsage, "found no material with an id");
  write("scene.toml", materials() + "material.b = { surface = \"bumps\", id = 1 }\n");
  expect_refusal(kUsage, "found 1, which material \"a\" has");
}

TEST_F(Glints, RefuseAnUnevenScale) {
  write_buffer();
  expect_refusal(kFile, "expected multiples of the scale 5", "--scale 5");
}

TEST_F(Glints, RefuseToWriteOverTheBuffer) {
  write_buffer();
  const Outcome outcome = mica("glints g.exr --scene scene.toml -o g.exr");
  EXPECT_EQ(outcome.code, kUsage);
}

}  // namespace
}  // namespace mica::host::app::glints_refusals_test
