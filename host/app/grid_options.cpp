#include "host/app/grid_options.h"

#include <fmt/format.h>

#include "mica/error.h"

namespace mica::host::app {

void add_grid_options(CLI::App* command, GridOptions* options) {
  const std::string group = "Of --ndf grid, which needs no map";
  command
      ->add_option("--alpha", options->alpha,
                   "Roughness of the smooth distribution, along u and v, 1e-4 to 1")
      ->delimiter(',')
      ->expected(1, 2)
      ->type_name("AX[,AY]")
      ->capture_default_str()
      ->group(group);
  command->add_option("--distribution", options->distribution, "Smooth distribution: ggx or beckmann")
      ->type_name("NAME")
      ->check(CLI::IsMember(std::vector<std::string>{"ggx", "beckmann"}))
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--microroughness", options->microroughness,
                   "Standard deviation of one glint's lobe on the disk, of all rows, 1e-4 to 1")
      ->type_name("SIGMA")
      ->group(group);
  command
      ->add_option("--density", options->density,
                   "Cells per unit area of uv, of which pi/4 hold a glint, 1 to 1e12")
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  command->add_option("--stretch", options->stretch, "Of each glint along u, 1/64 to 64")
      ->type_name("X")
      ->capture_default_str()
      ->group(group);
  command->add_option("--seed", options->seed, "Of the glints of a grid, or of --quantity sample")
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  command->add_option("--glint-masking", options->masking, "Of the BRDF: smith or cavity")
      ->type_name("NAME")
      ->check(CLI::IsMember(std::vector<std::string>{"smith", "cavity"}))
      ->capture_default_str()
      ->group(group);
}

GlintGrid to_glint_grid(const GridOptions& options) {
  GlintGrid grid;
  grid.distribution =
      options.distribution == "beckmann" ? Distribution::beckmann : Distribution::trowbridge_reitz;
  grid.alpha_x = options.alpha.front(), grid.alpha_y = options.alpha.back();
  grid.density = options.density;
  grid.stretch = options.stretch;
  grid.seed = options.seed;
  const std::string problem = glint_grid_problem(grid);
  if (!problem.empty()) throw UsageError("glints: " + problem);
  return grid;
}

GlintsDescription to_glints_description(const GridOptions& options) {
  const GlintGrid grid = to_glint_grid(options);
  GlintsDescription glints;
  glints.distribution = grid.distribution;
  glints.alpha = {grid.alpha_x, grid.alpha_y};
  glints.density = grid.density;
  glints.stretch = grid.stretch;
  glints.seed = grid.seed;
  if (options.masking == "cavity") glints.masking = GlintsDescription::Masking::cavity;
  return glints;
}

}  // namespace mica::host::app
