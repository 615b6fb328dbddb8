#pragma once

#include <string>

#include "host/app/command_line.h"
#include "host/app/max_memory.h"
#include "host/surface/surface.h"

namespace mica::host::app {

/// Options that say which normal map and how to read it.
struct MapOptions {
  std::string path, encoding, green = "up", interpolation = "bilinear", invalid = "refuse", part, channels,
                              precision = "as-is";
  double height_scale = 1;
  MaxMemory max_memory;
};

void add_map_options(CommandLine* command, MapOptions* options);

/// Loads the map; logs what was assumed and what cost accuracy. Throws what `make_surface` throws.
Surface load_map(const MapOptions& options, SurfaceReport* report);

/// Says what the map's steps cost at a roughness.
void log_precision(const Surface& surface, double roughness);

/// Logs notes and warnings.
void log_report(const SurfaceReport& report);

}  // namespace mica::host::app
