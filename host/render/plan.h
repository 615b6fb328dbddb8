#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/job/job.h"

namespace mica::host {

constexpr std::size_t kQueriesABatch = std::size_t{1} << 17;  ///< of one kernel launch, at most

/// One evaluator on one surface: what is built, uploaded and compiled for it.
struct PlannedEvaluator {
  std::string surface;          ///< name in the job; empty for a method that has no map
  std::string evaluator;        ///< name of the method: "triangles"
  int surface_index = -1;       ///< into Job::surfaces; -1: none
  int first_material = 0;       ///< into SceneDescription::materials: whose settings these are
  bool patch_brdf = false;      ///< lights are multiplied with its BRDF
  bool gathers = false;         ///< light from all around, by its BRDF
  bool asks_densities = false;  ///< a material multiplies lights with its density
  int width = 0, height = 0;
  Interpolation interpolation = Interpolation::bilinear;
  std::string kernel;          ///< file and options; several with commas between them
  std::size_t host_bytes = 0;  ///< of the surface
  std::size_t device_bytes = 0;
  std::vector<std::string> materials;  ///< that use it
};

/// Which draws of directions estimate the light from all around; either alone is right too, and noisier.
enum class Techniques { both, lights, brdf };

/// All that a job needs and nothing else. Surfaces and materials that no shape uses do not appear.
struct Plan {
  std::vector<PlannedEvaluator> evaluators;
  std::vector<int> evaluator_of_material;  ///< by index of SceneDescription::materials; -1: not used
  std::vector<std::string> channels;       ///< of the image, in order
  bool gathers_light = false;              ///< from all around: `samples` a footprint
  int samples = 0, max_bounces = 1;        ///< as the job asks for
  Techniques techniques = Techniques::both;
  int rows_a_block = 0;                          ///< image rows that are traced and evaluated together
  std::size_t queries_a_batch = 0;               ///< of one kernel launch, at most
  std::size_t queries_a_block = 0;               ///< of its rows that are on the device together, at most
  std::size_t host_bytes = 0, device_bytes = 0;  ///< of the whole, if every ray meets a glinting surface
  std::vector<std::string> warnings;             ///< what the job asks for and will not get
};

/// Derives the plan from the job; map files are opened for their size only. Throws FileError.
Plan make_plan(const Job& job);

/// Whether small footprints show something else than large ones: other glints, or a patch of its own.
bool has_no_limit(const PlannedEvaluator& planned);

/// Whether pixels can be integrated again: not where light is gathered by sampling, whose noise would be all
/// that is seen, nor where small footprints do not add up to large ones: those of a patch's BRDF, and of
/// glints without a map, of which each size sees its own.
bool can_audit_pixels(const Plan& plan);

/// Throws UsageError when several devices are no help: where light is gathered, and of patch BRDFs.
void check_sharing(const Plan& plan, std::size_t devices);

/// The plan in words, a line an item.
std::string describe(const Plan& plan);

/// The method of a planned evaluator, and its settings.
const Method& method_of(const Job& job, const PlannedEvaluator& planned);
const MethodSettings& settings_of(const Job& job, const PlannedEvaluator& planned);

}  // namespace mica::host
