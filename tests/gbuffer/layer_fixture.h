#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "host/gbuffer/glint_layer.h"
#include "host/image/stored_picture.h"
#include "tests/gbuffer/analytic_buffer.h"
#include "tests/image/folder.h"

namespace mica::host::analytic_buffer {

inline constexpr char kSphere[] = "type = \"sphere\"", kPlane[] = "type = \"plane\", size = 4";

/// Layers of buffers in memory, and pictures of the same shapes.
class LayerTest : public FolderTest {
 protected:
  void write(const std::string& file, const std::string& text) const { std::ofstream(path(file)) << text; }

  LayerResult make(const Image& buffer, const Camera& camera, const LayerSettings& settings = {},
                   int rows_a_block = 0, const std::string& scene = materials()) {
    write_exr(path("g.exr"), buffer);
    write("g.json", view(camera));
    return make(path("g"), {}, settings, rows_a_block, scene);
  }

  /// @param name of the buffer's file and of its camera's, without extensions.
  LayerResult make(const std::string& name, const BufferOptions& options, const LayerSettings& settings,
                   int rows_a_block, const std::string& scene) {
    write("scene.toml", scene);
    const BufferView seen = read_view(name + ".json");
    Job job = load_job(path("scene.toml"), {}, MethodRegistry::builtin(), 0, JobUse::layer);
    GBuffer opened(name + ".exr", seen, job.scene.materials, settings.scale, options);
    job = layer_job(job, seen, opened.window(), settings);
    Plan plan = make_plan(job);
    if (rows_a_block > 0) plan.rows_a_block = rows_a_block;
    LayerResult result =
        write_glint_layer(path("layer.exr"), job, plan, &opened, seen, settings, device_, [](int, int) {});
    layer_.emplace(path("layer.exr"));
    return result;
  }

  Image picture(const std::string& text) {
    write("job.toml", text);
    const Job job = load_job(path("job.toml"), {});
    return render(job, make_plan(job), device_, [](int, int) {}).image;
  }

  std::vector<float> channel(const std::string& name) {
    const std::vector<FileChannel>& all = layer_->channels();
    for (int n = 0; n < static_cast<int>(all.size()); ++n)
      if (all[static_cast<std::size_t>(n)].name == name) return layer_->read(0, layer_->window().height, {n});
    ADD_FAILURE() << "no channel " << name;
    return {};
  }

  static std::vector<float> channel(const Image& image, const std::string& name) {
    const auto found = std::find(image.channels.begin(), image.channels.end(), name);
    std::vector<float> values;
    for (auto n = static_cast<std::size_t>(found - image.channels.begin()); n < image.pixels.size();
         n += image.channels.size())
      values.push_back(image.pixels[n]);
    return values;
  }

  Device device_{0};
  std::optional<ChannelFile> layer_;
};

}  // namespace mica::host::analytic_buffer
