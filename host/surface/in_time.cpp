#include "host/surface/in_time.h"

#include <algorithm>
#include <utility>

namespace mica::host {

bool moves(const SurfaceDescription& surface) {
  if (const auto* waves = std::get_if<WavesSurface>(&surface.source)) return waves->time_scale != 0;
  const auto* sum = std::get_if<LayersSurface>(&surface.source);
  return sum && std::any_of(sum->layers.begin(), sum->layers.end(),
                            [](const SurfaceLayer& layer) { return moves(layer.surface); });
}

SurfaceDescription after(SurfaceDescription surface, double seconds) {
  if (auto* waves = std::get_if<WavesSurface>(&surface.source))
    waves->time_seconds += waves->time_scale * seconds;
  if (auto* sum = std::get_if<LayersSurface>(&surface.source))
    for (SurfaceLayer& layer : sum->layers) layer.surface = after(std::move(layer.surface), seconds);
  return surface;
}

}  // namespace mica::host
