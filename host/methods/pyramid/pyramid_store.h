#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "host/device/device.h"
#include "host/methods/pyramid/moment_pyramid.h"
#include "host/methods/pyramid/pyramid_level_batches.h"
#include "host/surface/surface.h"

namespace mica::host {

/// What the levels of one width of cells may take; finer ones are not built. With the texels of a 2048^2 map
/// that is 126 MiB.
std::size_t pyramid_levels_bytes(int map_width, int map_height);

/// Levels of a surface's pyramids on the device, by the width of their cells; built when they are asked for.
/// Pyramids of several precisions may share one.
class PyramidStore {
 public:
  /// Builds nothing yet. `device` and `surface` must outlive this.
  /// @param levels_bytes of the levels of one width. @param batch_queries a launch, at most.
  PyramidStore(Device& device, const Surface& surface, std::size_t levels_bytes, WaveForm wave_form,
               std::size_t batch_queries);

  /// Which levels there are.
  const PyramidLevels& levels(double cell_width);
  /// One of them.
  PyramidLevelBatches& level(double cell_width, int block);
  /// Drops all levels of other widths.
  void keep(const std::set<double>& cell_widths);

  WaveForm wave_form() const { return wave_form_; }
  std::size_t device_bytes() const;
  double build_seconds() const { return build_seconds_; }
  double device_seconds() const;

 private:
  Device& device_;
  const Surface& surface_;
  std::size_t levels_bytes_;
  WaveForm wave_form_;
  std::size_t batch_queries_;
  double build_seconds_ = 0, dropped_device_seconds_ = 0;
  std::map<double, PyramidLevels> levels_;
  std::map<std::pair<double, int>, PyramidLevelBatches> built_;
};

}  // namespace mica::host
