#include "host/engine/built_job.h"

#include <fmt/format.h>

#include <cmath>

#include "host/base/stopwatch.h"
#include "host/engine/make_evaluator.h"
#include "host/engine/make_patch_brdf.h"
#include "host/engine/ndf_brdf.h"

namespace mica {
namespace {

constexpr double kUnusedAlpha = 0.1;  // of materials that no shape has

/// Beckmann roughness of a map as a whole, for Smith's G: slopes of variance alpha^2 / 2 an axis, and the
/// roughness.
double masking_alpha(const Surface& surface, double roughness) {
  double sum = 0;
  for (const Eigen::Vector2d& s : surface.normals()) sum += s.squaredNorm() / (1 - s.squaredNorm());
  const double slope_variance = sum / static_cast<double>(surface.normals().size());
  return std::sqrt(slope_variance + 2 * roughness * roughness);
}

}  // namespace

BuiltJob::BuiltJob(const Job& job, const Plan& plan, Device& device)
    : job_(job), plan_(plan), surfaces_(make_surfaces()), scene_(make_scene()) {
  const Stopwatch watch;
  for (std::size_t n = 0; n < surfaces_.size(); ++n) build(n, device);
  build_seconds_ = watch.seconds();
}

void BuiltJob::build(std::size_t n, Device& device) {
  const PlannedEvaluator& planned = plan_.evaluators[n];
  evaluators_.emplace_back();
  brdfs_.emplace_back();
  if (planned.asks_densities)
    evaluators_[n] = make_evaluator(planned.evaluator, device, surfaces_[n], planned.elements);
  if (planned.patch_brdf) {
    brdfs_[n] = make_patch_brdf(planned.evaluator, device, surfaces_[n],
                                {planned.masking, planned.elements, planned.compensation, planned.energy});
  } else if (plan_.gathers_light) {
    // Of the densities, that of triangles alone is that of the surface's normals, and not an approximation.
    const auto draws =
        planned.evaluator == "triangles" ? NdfBrdf::Draws::surface_normals : NdfBrdf::Draws::smooth_lobe;
    brdfs_[n] = std::make_unique<NdfBrdf>(*evaluators_[n], surfaces_[n], draws);
  }
}

std::vector<Surface> BuiltJob::make_surfaces() {
  const Stopwatch watch;
  std::vector<Surface> surfaces;
  for (const PlannedEvaluator& planned : plan_.evaluators) {
    SurfaceReport report;
    const SurfaceDescription& description = job_.surfaces[planned.surface_index];
    surfaces.push_back(make_surface(description, &report));
    for (const std::string& note : report.notes)
      notes_.push_back(fmt::format("surface {}: {}", description.name, note));
    for (const std::string& warning : report.warnings)
      warnings_.push_back(fmt::format("surface {}: {}", description.name, warning));
  }
  surface_seconds_ = watch.seconds();
  return surfaces;
}

Scene BuiltJob::make_scene() {
  const Stopwatch watch;
  std::vector<double> alphas;
  LightGathering gathering{plan_.gathers_light, {}};
  for (std::size_t n = 0; n < job_.scene.materials.size(); ++n) {
    const int evaluator = plan_.evaluator_of_material[n];
    // A coat bends directions before they reach the patch, and is made for densities.
    gathering.patch_materials.push_back(evaluator >= 0 && plan_.evaluators[evaluator].patch_brdf &&
                                        !job_.scene.materials[n].coat);
    alphas.push_back(evaluator < 0 ? kUnusedAlpha
                                   : masking_alpha(surfaces_[evaluator], job_.scene.materials[n].roughness));
  }
  Scene scene(job_.scene, job_.image.width, job_.image.height, job_.image.subpixels, alphas,
              std::move(gathering));
  scene_seconds_ = watch.seconds();
  return scene;
}

std::vector<const Surface*> BuiltJob::surfaces() const {
  std::vector<const Surface*> pointers;
  for (const Surface& surface : surfaces_) pointers.push_back(&surface);
  return pointers;
}

std::size_t BuiltJob::device_bytes() const {
  std::size_t bytes = 0;
  for (std::size_t n = 0; n < evaluators_.size(); ++n) {
    if (evaluators_[n]) bytes += evaluators_[n]->device_bytes();
    if (plan_.evaluators[n].patch_brdf) bytes += brdfs_[n]->device_bytes();
  }
  return bytes;
}

double BuiltJob::device_seconds() const {
  double seconds = 0;
  for (std::size_t n = 0; n < evaluators_.size(); ++n) {
    if (evaluators_[n]) seconds += evaluators_[n]->device_seconds();
    if (plan_.evaluators[n].patch_brdf) seconds += brdfs_[n]->device_seconds();
  }
  return seconds;
}

PendingBlock::PendingBlock(TracedRows rows, const BuiltJob& built)
    : rows_(std::move(rows)), parts_(built.plan().evaluators.size()) {
  std::vector<std::vector<Query>> queries(parts_.size());
  for (std::size_t n = 0; n < rows_.queries.size(); ++n) {
    const int evaluator = built.plan().evaluator_of_material[rows_.queries[n].material];
    parts_[evaluator].places.push_back(n);
    queries[evaluator].push_back(rows_.queries[n].query);
  }
  for (std::size_t n = 0; n < parts_.size(); ++n)
    if (!queries[n].empty()) parts_[n].pending = built.evaluator(n).start(queries[n]);
}

std::vector<float> PendingBlock::wait() {
  std::vector<float> densities(rows_.queries.size());
  for (Part& part : parts_) {
    if (!part.pending) continue;
    const std::vector<float> answers = part.pending->wait();
    for (std::size_t n = 0; n < answers.size(); ++n) densities[part.places[n]] = answers[n];
  }
  return densities;
}

}  // namespace mica
