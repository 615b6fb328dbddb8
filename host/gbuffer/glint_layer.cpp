#include "host/gbuffer/glint_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host/image/exr_rows.h"
#include "host/render/film.h"

namespace mica::host {
namespace {

struct AovChannels {
  LayerAov aov;
  std::string word;                   ///< of the picture's AOV; empty: none
  std::vector<std::string> channels;  ///< of the layer
};
const std::vector<AovChannels>& aov_channels() {
  static const std::vector<AovChannels> all = {
      {LayerAov::density, "ndf", {"D"}},
      {LayerAov::footprint, "footprint", {"footprint.CUU", "footprint.CUV", "footprint.CVV"}},
      {LayerAov::error, "error", {"error"}},
      {LayerAov::coverage, "", {"coverage"}}};
  return all;
}

bool has(const LayerSettings& settings, LayerAov aov) {
  return std::find(settings.aovs.begin(), settings.aovs.end(), aov) != settings.aovs.end();
}

std::vector<std::string> channels_of_layer(const LayerSettings& settings, const BufferView& view) {
  std::vector<std::string> channels = {"R", "G", "B", "A"};
  for (const AovChannels& aov : aov_channels())
    if (has(settings, aov.aov)) channels.insert(channels.end(), aov.channels.begin(), aov.channels.end());
  if (settings.per_lamp)
    for (const BufferLamp& lamp : view.lamps)
      for (const char* color : {".R", ".G", ".B"}) channels.push_back(lamp.name + color);
  return channels;
}

FileWindow window_of_layer(FileWindow window, int scale) {
  for (int* size :
       {&window.width, &window.height, &window.left, &window.top, &window.whole_width, &window.whole_height})
    *size /= scale;
  return window;
}

/// Without what describes the buffer's own pixels and file.
std::map<std::string, std::string> texts_of_source(const GBuffer& buffer) {
  static const std::set<std::string> own = {"compression", "name",          "type",
                                            "channels",    "lineOrder",     "chunkCount",
                                            "DateTime",    "textureformat", "ImageDescription"};
  std::map<std::string, std::string> texts;
  for (const auto& [name, text] : buffer.metadata())
    if (own.count(name) == 0 && name.find("oiio:") != 0 && name.find("openexr:") != 0) texts[name] = text;
  return texts;
}

/// Puts the layer's rows together: those of all lamps, and of each.
class LayerRows {
 public:
  LayerRows(const Plan& plan, int width, const LayerSettings& settings, std::size_t lamps)
      : plan_(plan), width_(width), settings_(settings), lamps_(settings.per_lamp ? lamps : 0) {}

  std::vector<float> of(const TracedRows& rows, const std::vector<float>& densities,
                        const std::vector<float>& errors) {
    Film film(width_, rows.row_count, plan_.channels, rows.first_row);
    film.add(rows, densities, errors);
    repairs_.not_finite += film.repairs().not_finite, repairs_.negative += film.repairs().negative;
    const Image all = film.take();
    std::vector<std::vector<Eigen::Vector3d>> by_lamp;
    for (std::size_t lamp = 0; lamp < lamps_; ++lamp) by_lamp.push_back(of_lamp(rows, densities, lamp));
    std::vector<float> pixels;
    for (std::size_t pixel = 0; pixel < rows.coverage.size(); ++pixel) {
      const float* from = &all.pixels[pixel * all.channels.size()];
      pixels.insert(pixels.end(), from, from + 3);
      pixels.push_back(0);  // light is added, and covers nothing
      add_aovs(all, from, rows.coverage[pixel], &pixels);
      for (const auto& lamp : by_lamp)
        for (const double value : lamp[pixel]) pixels.push_back(static_cast<float>(value));
    }
    return pixels;
  }

  const FilmRepairs& repairs() const { return repairs_; }

 private:
  /// The light of one lamp, whose queries alone have densities.
  std::vector<Eigen::Vector3d> of_lamp(const TracedRows& rows, std::vector<float> densities,
                                       std::size_t lamp) const {
    for (std::size_t n = 0; n < densities.size(); ++n)
      if (rows.queries[n].light != lamp) densities[n] = 0;
    FilmRepairs counted_already;
    return radiance_of(rows, densities, &counted_already);
  }

  void add_aovs(const Image& all, const float* from, float coverage, std::vector<float>* pixels) const {
    for (const AovChannels& aov : aov_channels()) {
      if (!has(settings_, aov.aov)) continue;
      if (aov.word.empty()) {
        pixels->push_back(coverage);
        continue;
      }
      const auto first = std::find_if(all.channels.begin(), all.channels.end(), [&](const std::string& name) {
        return name.find(aov.word + ".") == 0;
      });
      const float* values = from + (first - all.channels.begin());
      pixels->insert(pixels->end(), values, values + aov.channels.size());
    }
  }

  const Plan& plan_;
  int width_;
  const LayerSettings& settings_;
  std::size_t lamps_;
  FilmRepairs repairs_;
};

std::vector<std::string> describe(const BufferCounts& counts) {
  std::vector<std::string> lines;
  if (counts.one_sided > 0)
    lines.push_back(
        fmt::format("{} of {} pixels lie at rims and seams: their footprints are those of derivatives, or of "
                    "neighbours on one side",
                    counts.one_sided, counts.covered));
  return lines;
}

std::vector<std::string> describe_losses(const BufferCounts& counts) {
  std::vector<std::string> lines;
  if (counts.alone > 0)
    lines.push_back(
        fmt::format("{} of {} pixels have no neighbours on their surface along one axis: without a "
                    "footprint they show no glints",
                    counts.alone, counts.covered));
  if (counts.broken > 0)
    lines.push_back(fmt::format(
        "{} pixels have a position, a normal or uv that is no number: they show no glints", counts.broken));
  return lines;
}

/// Sums of samples cannot be narrower than these lie apart, unless one lies in the pixel's middle.
void check_width(const LayerSettings& settings) {
  constexpr double most_wider = 1.05;
  if (settings.scale == 1) return;
  const PixelFilter filter(settings.filter);
  const double sigma = std::sqrt(filter.by_few().variance());
  const auto sigma_of_sum = [&](int scale) {
    return std::sqrt(filter.for_layer().on_lattice(scale).variance());
  };
  const double found = sigma_of_sum(settings.scale);
  if (found <= most_wider * sigma) return;
  int enough = settings.scale;
  while (sigma_of_sum(enough) > most_wider * sigma) ++enough;
  throw UsageError(
      fmt::format("--scale {}: the filter {} would have a standard deviation of {:.2f} pixels in place of "
                  "{:.2f}; expected 1, or {} or more",
                  settings.scale, word_of(settings.filter.kind), found, sigma, enough));
}

}  // namespace

void check(const LayerSettings& settings) {
  constexpr int most_scale = 16;
  constexpr double least_width = 0.1, most_width = 8;
  const double width = settings.filter.width;
  if (settings.filter.kind == FilterKind::subpixels)
    throw UsageError("--filter subpixels: expected gaussian, blackman-harris or box");
  if (settings.scale < 1 || settings.scale > most_scale)
    throw UsageError(fmt::format("scale {}: expected 1 to {}", settings.scale, most_scale));
  if (width != 0 && !(width >= least_width && width <= most_width))
    throw UsageError(
        fmt::format("filter width {}: expected {} to {} pixels", width, least_width, most_width));
  check_width(settings);
}

Job layer_job(Job job, const BufferView& view, const FileWindow& buffer, const LayerSettings& settings) {
  check(settings);
  if (settings.per_lamp)
    for (const MaterialDescription& material : job.scene.materials)
      if (material.id && job.methods.get(material.ndf).traits().lit_by_brdf)
        throw UsageError(
            fmt::format("--per-lamp: material {} has ndf \"{}\", whose BRDF sums up all lamps; expected a "
                        "density of normals, as triangles",
                        material.name, material.ndf));
  job.scene.lights.clear();
  for (const BufferLamp& lamp : view.lamps) job.scene.lights.push_back(lamp.light);
  job.image.width = buffer.width / settings.scale, job.image.height = buffer.height / settings.scale;
  job.image.subpixels = settings.scale;
  job.image.filter = settings.filter;
  for (const AovChannels& aov : aov_channels())
    if (has(settings, aov.aov) && !aov.word.empty()) job.image.aovs.push_back(aov.word);
  return job;
}

LayerResult write_glint_layer(const std::string& path, const Job& job, const Plan& plan, GBuffer* buffer,
                              const BufferView& view, const LayerSettings& settings, Device& device,
                              const RenderProgress& progress) {
  BufferTracer tracer(buffer, view, settings.scale);
  BuiltJob built(job, plan, device, job.frames.first, [&](const Scene& scene, int first_row, int row_count) {
    return tracer.trace(scene, first_row, row_count);
  });
  std::map<std::string, std::string> metadata = texts_of_source(*buffer);
  for (const auto& [name, text] : picture_identity(job, built.frame(), built.inputs())) metadata[name] = text;
  metadata["mica:device"] = device.info().name;
  constexpr std::size_t letters_of_audit = 160;
  LayerResult layer;
  layer.channels = channels_of_layer(settings, view);
  ExrRows file(path, window_of_layer(buffer->window(), settings.scale), layer.channels, metadata,
               {{"mica:audit", letters_of_audit}});
  LayerRows rows(plan, job.image.width, settings, view.lamps.size());
  layer.result = evaluate_frame(
      built, built.frame(), device.info(), progress, {0, job.image.height},
      [&](const TracedRows& block, const std::vector<float>& densities, const std::vector<float>& errors) {
        file.append(rows.of(block, densities, errors));
      });
  tell_repairs(rows.repairs(), &layer.result);
  layer.counts = tracer.counts();
  for (const std::string& line : describe(layer.counts)) layer.result.surface_notes.push_back(line);
  for (const std::string& line : describe_losses(layer.counts)) layer.result.surface_warnings.push_back(line);
  std::map<std::string, std::string> audit;
  if (layer.result.audit.samples) audit["mica:audit"] = describe(layer.result.audit);
  file.finish(audit);
  return layer;
}

}  // namespace mica::host
