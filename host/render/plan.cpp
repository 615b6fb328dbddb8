#include "host/render/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "host/render/calibration_rows.h"
#include "host/scene/aovs.h"
#include "host/scene/disk_cells.h"
#include "host/scene/scene.h"
#include "host/scene/shading.h"
#include "host/surface/map_size.h"
#include "kernels/types.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// Of a block at the least: with fewer too much is traced twice, what pixels see of the rows around it. More
/// where their queries, sixteen a pixel and lamp if no pixel is fitted, would not fill the host's memory; the
/// device has no more of them at a time than few rows may ask.
constexpr std::size_t kFewRows = 16, kManyRows = 32, kMostQueriesOfManyRows = 1 << 21;
constexpr int kBatchesInFlight = 2;  // one on the device while the next is traced

PlannedEvaluator plan_evaluator(const Job& job, int surface_index, int material_index, bool gathers) {
  const MaterialDescription& material = job.scene.materials[static_cast<std::size_t>(material_index)];
  const Method& method = job.methods.get(material.ndf);
  const MethodTraits traits = method.traits();
  PlannedEvaluator planned;
  planned.evaluator = material.ndf;
  planned.first_material = material_index;
  planned.patch_brdf = traits.lit_by_brdf;
  planned.gathers = gathers;
  if (!traits.map) return planned;
  const SurfaceDescription& surface = job.surfaces[static_cast<std::size_t>(surface_index)];
  const MapSize size = map_size(surface);
  planned.surface = surface.name;
  planned.surface_index = surface_index;
  planned.width = size.width, planned.height = size.height;
  planned.interpolation = surface.interpolation;
  planned.host_bytes = sizeof(Eigen::Vector2d) * size.width * size.height;
  return planned;
}

/// Whether half vectors turn, or lamps or materials make lobes longer one way.
bool may_ask_first_order(const Job& job) {
  return job.image.filter.kind != FilterKind::subpixels ||
         std::any_of(
             job.scene.materials.begin(), job.scene.materials.end(),
             [](const MaterialDescription& material) { return material.long_roughness.has_value(); }) ||
         std::any_of(job.scene.lights.begin(), job.scene.lights.end(), has_extent);
}

/// What the evaluator takes on the device, and its kernel.
void plan_structure(const Job& job, PlannedEvaluator* planned) {
  const bool brdf = planned->patch_brdf || planned->gathers;
  const StructureSize size =
      method_of(job, *planned)
          .structure({planned->width, planned->height, planned->interpolation, planned->asks_densities, brdf},
                     settings_of(job, *planned));
  planned->device_bytes = size.device_bytes;
  planned->host_bytes += size.host_bytes;
  planned->kernel = size.kernel;
  const MethodTraits traits = method_of(job, *planned).traits();
  if (planned->surface_index >= 0 && planned->asks_densities && may_ask_first_order(job) &&
      traits.first_order && !traits.chooses)  // what it chooses is not known yet
    planned->kernel += fmt::format(", {} -DMICA_FIRST_ORDER=1", size.kernel);
}

/// Index of the evaluator that a material needs, planned now if it is the first to need it.
int evaluator_for(const Job& job, int material_index, Plan* plan) {
  const MaterialDescription& material = job.scene.materials[static_cast<std::size_t>(material_index)];
  const Method& method = job.methods.get(material.ndf);
  int surface_index = -1;
  if (method.traits().map) {
    const auto surface =
        std::find_if(job.surfaces.begin(), job.surfaces.end(),
                     [&](const SurfaceDescription& s) { return s.name == material.surface; });
    surface_index = static_cast<int>(surface - job.surfaces.begin());
  }
  std::vector<PlannedEvaluator>* planned = &plan->evaluators;
  const auto found = std::find_if(planned->begin(), planned->end(), [&](const PlannedEvaluator& p) {
    return p.surface_index == surface_index && p.evaluator == material.ndf &&
           method.share(settings_of(job, p), *material.settings, plan->gathers_light);
  });
  const int index = static_cast<int>(found - planned->begin());
  if (found == planned->end())
    planned->push_back(plan_evaluator(job, surface_index, material_index, plan->gathers_light));
  PlannedEvaluator& used = (*planned)[static_cast<std::size_t>(index)];
  used.materials.push_back(material.name);
  used.asks_densities |= !used.patch_brdf;
  return index;
}

/// `error` is asked only of methods that say something of their error.
void check_estimates(const Job& job, const Plan& plan) {
  if (std::count(plan.channels.begin(), plan.channels.end(), "error.Y") == 0) return;
  const std::vector<std::string> able =
      job.methods.names([](const MethodTraits& traits) { return traits.estimates_errors && traits.jobs; });
  for (const PlannedEvaluator& planned : plan.evaluators)
    if (!method_of(job, planned).traits().estimates_errors)
      throw UsageError(
          fmt::format("image.aovs: \"error\" wants materials with ndf \"{}\"; material {} has \"{}\"",
                      fmt::join(able, "\" or \""), planned.materials.front(), planned.evaluator));
}

double mebibytes(std::size_t bytes) {
  return static_cast<double>(bytes) / (1 << 20);
}

/// The channel `ndf.Y` is of densities, which lights that are multiplied with a BRDF never ask for; the audit
/// takes such a BRDF where its method has a definition in double precision.
std::vector<std::string> missing_densities(const Job& job, const Plan& plan) {
  const bool has_channel =
      std::find(plan.channels.begin(), plan.channels.end(), "ndf.Y") != plan.channels.end();
  std::vector<std::string> warnings;
  for (const PlannedEvaluator& e : plan.evaluators) {
    if (!e.patch_brdf || e.asks_densities) continue;
    std::vector<std::string> asked;
    if (job.audit.samples > 0 && !method_of(job, e).traits().brdf_references) asked.emplace_back("[audit]");
    if (has_channel) asked.emplace_back("the AOV ndf");
    if (asked.empty()) continue;
    warnings.push_back(
        fmt::format("{} {} nothing of material {}: its light is that of the BRDF of {}, and not of a density",
                    fmt::join(asked, " and "), asked.size() > 1 ? "see" : "sees",
                    fmt::join(e.materials, ", "), e.evaluator));
  }
  return warnings;
}

/// Of the shapes; of a layer, which has none, those that pixels may name.
std::set<std::string> used_materials(const SceneDescription& scene) {
  std::set<std::string> used;
  for (const ShapeDescription& shape : scene.shapes) {
    used.insert(shape.material);
    for (const PartMaterial& part : shape.parts) used.insert(part.material);
  }
  if (scene.shapes.empty())
    for (const MaterialDescription& material : scene.materials)
      if (material.id) used.insert(material.name);
  return used;
}

std::size_t samples_a_row(const Job& job) {
  return static_cast<std::size_t>(job.image.width) * job.image.subpixels * job.image.subpixels;
}

/// Of lamps that are cut into parts, beside one a lamp.
std::size_t queries_of_parts_a_row(const Job& job) {
  const int parts = cells_of(LampParts::of(job.accuracy.lamp_parts, job.accuracy.tolerance).most_rings);
  const auto cut = std::count_if(job.scene.lights.begin(), job.scene.lights.end(), widens_lobes);
  return samples_a_row(job) * static_cast<std::size_t>(cut * (parts - 1));
}

/// Lobes that are longer one way are a matter of densities, by methods that take them.
void check_long_lobes(const Job& job) {
  for (const MaterialDescription& material : job.scene.materials) {
    if (!material.long_roughness) continue;
    const MethodTraits traits = job.methods.get(material.ndf).traits();
    if (!traits.first_order || traits.lit_by_brdf)
      throw UsageError(
          fmt::format("material.{}.roughness: found 2 numbers, which ndf \"{}\" does not take; expected one, "
                      "or ndf \"{}\"",
                      material.name, material.ndf,
                      fmt::join(job.methods.names([](const MethodTraits& t) {
                        return t.jobs && t.first_order && !t.lit_by_brdf;
                      }),
                                "\" or \"")));
    if (!job.scene.environments.empty() || job.image.max_bounces > 1)
      throw UsageError(
          fmt::format("material.{}.roughness: found 2 numbers beside light from all around; expected one",
                      material.name));
  }
}

}  // namespace

bool has_no_limit(const PlannedEvaluator& planned) {
  return planned.patch_brdf || planned.surface_index < 0;
}

bool can_audit_pixels(const Plan& plan) {
  return !plan.gathers_light && std::none_of(plan.evaluators.begin(), plan.evaluators.end(), has_no_limit);
}

const Method& method_of(const Job& job, const PlannedEvaluator& planned) {
  return job.methods.get(planned.evaluator);
}

const MethodSettings& settings_of(const Job& job, const PlannedEvaluator& planned) {
  return *job.scene.materials[static_cast<std::size_t>(planned.first_material)].settings;
}

Plan make_plan(const Job& job) {
  check_long_lobes(job);
  Plan plan;
  plan.gathers_light = !job.scene.environments.empty() || job.image.max_bounces > 1;
  if (plan.gathers_light) plan.samples = job.image.samples, plan.max_bounces = job.image.max_bounces;
  const std::set<std::string> used = used_materials(job.scene);
  for (std::size_t n = 0; n < job.scene.materials.size(); ++n)
    plan.evaluator_of_material.push_back(
        used.count(job.scene.materials[n].name) ? evaluator_for(job, static_cast<int>(n), &plan) : -1);

  plan.channels = channels_of(job.image.aovs);
  check_estimates(job, plan);
  plan.warnings = missing_densities(job, plan);
  if (job.audit.pixels > 0 && !can_audit_pixels(plan))
    plan.warnings.emplace_back(
        plan.gathers_light
            ? "[audit] draws no pixels where light is gathered from all around"
            : "[audit] draws no pixels where small footprints show something else than large ones: "
              "of a patch's BRDF, and of glints without a map");
  plan.queries_a_batch = kQueriesABatch;
  const std::size_t queries_a_row = samples_a_row(job) * std::max<std::size_t>(job.scene.lights.size(), 1);
  const std::size_t rows_of_batch = kQueriesABatch / queries_a_row;
  const auto rows_at_least = [&](std::size_t rows) {
    const std::size_t least = std::min<std::size_t>(rows, static_cast<std::size_t>(job.image.height));
    return std::clamp<std::size_t>(rows_of_batch, least, static_cast<std::size_t>(job.image.height));
  };
  const bool many_rows = kManyRows * queries_a_row <= kMostQueriesOfManyRows;
  plan.rows_a_block = static_cast<int>(rows_at_least(many_rows ? kManyRows : kFewRows));

  std::size_t block = rows_at_least(kFewRows) * queries_a_row;
  if (plan.gathers_light)  // of each sample's directions two questions, in batches; see gather_light
    block += 2 * std::min<std::size_t>(plan.queries_a_batch, static_cast<std::size_t>(plan.rows_a_block) *
                                                                 job.image.width * job.image.subpixels *
                                                                 job.image.subpixels * plan.samples);
  plan.queries_a_block = block;
  for (PlannedEvaluator& evaluator : plan.evaluators) {
    plan_structure(job, &evaluator);
    plan.host_bytes += evaluator.host_bytes;
    plan.device_bytes += evaluator.device_bytes;
  }
  plan.device_bytes += kBatchesInFlight * block * (sizeof(device_types::mica_map_query) + sizeof(float));
  const std::size_t traced = plan.rows_a_block * queries_a_row;
  const std::size_t of_parts = plan.rows_a_block * queries_of_parts_a_row(job);
  const bool chooses = std::any_of(
      plan.evaluators.begin(), plan.evaluators.end(),
      [&](const PlannedEvaluator& evaluator) { return method_of(job, evaluator).traits().chooses; });
  if (chooses) plan.host_bytes += kMostBlocksLookedAt * (traced + of_parts) * sizeof(GlintQuery);
  plan.host_bytes += kBatchesInFlight * ((traced + of_parts) * (sizeof(GlintQuery) + sizeof(float)) +
                                         block * (sizeof(Query) + sizeof(device_types::mica_map_query)));
  plan.host_bytes += sizeof(float) * plan.channels.size() * job.image.width * job.image.height;
  return plan;
}

void check_sharing(const Plan& plan, std::size_t devices) {
  const bool has_brdf = std::any_of(plan.evaluators.begin(), plan.evaluators.end(),
                                    [](const PlannedEvaluator& planned) { return planned.patch_brdf; });
  if (devices > 1 && (plan.gathers_light || has_brdf))
    throw UsageError(fmt::format(
        "{} devices: only densities of lamps are shared among several, and this job {}; expected one device",
        devices, plan.gathers_light ? "gathers light from all around" : "has a patch BRDF"));
}

std::string describe(const Plan& plan) {
  std::string text;
  for (const PlannedEvaluator& e : plan.evaluators) {
    if (e.surface_index < 0) {
      text += fmt::format("{} for {}: no map, nothing built, kernel {}\n", e.evaluator,
                          fmt::join(e.materials, ", "), e.kernel);
      continue;
    }
    text += fmt::format("{} on surface {} ({} x {} texels, {}) for {}: {:.1f} MiB on the device, kernel {}\n",
                        e.evaluator, e.surface, e.width, e.height, word_of(e.interpolation),
                        fmt::join(e.materials, ", "), mebibytes(e.device_bytes), e.kernel);
  }
  if (plan.gathers_light)
    text += fmt::format(
        "light from all around: 2 x {} directions a footprint, by the light and by the material, up to "
        "{} bounces\n",
        plan.samples, plan.max_bounces);
  text += fmt::format("channels {}\n", fmt::join(plan.channels, " "));
  text += fmt::format("blocks of {} rows, batches of at most {} queries\n", plan.rows_a_block,
                      plan.queries_a_batch);
  text += fmt::format("memory at most {:.0f} MiB on the device, {:.0f} MiB on the host\n",
                      mebibytes(plan.device_bytes), mebibytes(plan.host_bytes));
  for (const std::string& warning : plan.warnings) text += warning + '\n';
  return text;
}

}  // namespace mica::host
