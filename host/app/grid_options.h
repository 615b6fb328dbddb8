#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/methods/grid/grid_query.h"
#include "host/scene/glints_description.h"

namespace mica::host::app {

/// Options of `--ndf grid`: a surface of glints that needs no map.
struct GridOptions {
  std::vector<double> alpha = {0.3};
  std::string distribution = "ggx";
  double density = 1e6, stretch = 1;
  std::optional<double> microroughness;
  std::uint32_t seed = 1;
  std::string masking = "smith";
};

void add_grid_options(CLI::App* command, GridOptions* options);

/// Throws UsageError for values out of range.
GlintGrid to_glint_grid(const GridOptions& options);
GlintsDescription to_glints_description(const GridOptions& options);

}  // namespace mica::host::app
