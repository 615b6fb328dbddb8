#pragma once

#include <string>
#include <vector>

#include "host/gbuffer/gbuffer.h"
#include "host/gbuffer/trace_buffer.h"
#include "host/gbuffer/view.h"
#include "host/job/job.h"
#include "host/render/render.h"

namespace mica::host {

/// What a layer of glints shows besides them.
enum class LayerAov { density, footprint, error, coverage };

template <>
struct Words<LayerAov> {
  static constexpr Word<LayerAov> all[] = {{"D", LayerAov::density},
                                           {"footprint", LayerAov::footprint},
                                           {"error", LayerAov::error},
                                           {"coverage", LayerAov::coverage}};
};

struct LayerSettings {
  FilterDescription filter{FilterKind::gaussian, 0};  ///< that of the picture below
  int scale = 1;  ///< pixels of the buffer a pixel of the layer, along each axis
  std::vector<LayerAov> aovs;
  bool per_lamp = false;  ///< a layer for each lamp besides their sum
};

/// Throws UsageError for settings that no layer can have.
void check(const LayerSettings& settings);

/// A job for a layer: one that was read for it, in the light of the view's lamps. Throws UsageError for
/// settings that do not go together.
Job layer_job(Job job, const BufferView& view, const FileWindow& buffer, const LayerSettings& settings);

/// A finished layer: as of a picture whose pixels are in the file, and how they were found.
struct LayerResult {
  RenderResult result;
  BufferCounts counts;
  std::vector<std::string> channels;
};

/// Evaluates a layer of glints over the picture that `buffer` belongs to, and writes it row by row:
/// premultiplied R, G, B, which are those of glints alone, A = 0, and what the settings ask for besides; of
/// the buffer's size (over the scale), windows and compression, with its texts. The file depends on its
/// inputs alone, bit for bit.
/// @param job of layer_job. @param plan of it. Throws mica::Error; then there is no file.
LayerResult write_glint_layer(const std::string& path, const Job& job, const Plan& plan, GBuffer* buffer,
                              const BufferView& view, const LayerSettings& settings, Device& device,
                              const RenderProgress& progress);

}  // namespace mica::host
