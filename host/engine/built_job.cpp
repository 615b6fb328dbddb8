#include "host/engine/built_job.h"

#include <fmt/format.h>

#include <cmath>

#include "host/base/stopwatch.h"
#include "host/engine/glint_plan.h"
#include "host/engine/grid_brdf.h"
#include "host/engine/make_evaluator.h"
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
  glints_.resize(surfaces_.size());
  for (std::size_t n = 0; n < surfaces_.size(); ++n) {
    const PlannedEvaluator& planned = plan.evaluators[n];
    if (planned.glints_material >= 0) {
      auto glints = make_glint_evaluator(job.scene.materials[planned.glints_material], device);
      glints_[n] = glints.get();
      evaluators_.push_back(std::move(glints));
    } else {
      evaluators_.push_back(make_evaluator(planned.evaluator, device, *surfaces_[n]));
    }
    if (plan.gathers_light) brdfs_.push_back(make_brdf(n, device));
  }
  build_seconds_ = watch.seconds();
}

std::unique_ptr<PatchBrdf> BuiltJob::make_brdf(std::size_t n, Device& device) const {
  const PlannedEvaluator& planned = plan_.evaluators[n];
  if (planned.glints_material >= 0)
    return std::make_unique<GridBrdf>(device, *job_.scene.materials[planned.glints_material].glints);
  // Of the densities, that of triangles alone is that of the surface's normals, and not an approximation.
  const auto draws =
      planned.evaluator == "triangles" ? NdfBrdf::Draws::surface_normals : NdfBrdf::Draws::smooth_lobe;
  return std::make_unique<NdfBrdf>(*evaluators_[n], *surfaces_[n], draws);
}

std::vector<std::optional<Surface>> BuiltJob::make_surfaces() {
  const Stopwatch watch;
  std::vector<std::optional<Surface>> surfaces;
  for (const PlannedEvaluator& planned : plan_.evaluators) {
    if (planned.surface_index < 0) {
      surfaces.emplace_back();
      continue;
    }
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
  for (std::size_t n = 0; n < job_.scene.materials.size(); ++n) {
    const int evaluator = plan_.evaluator_of_material[n];
    const MaterialDescription& material = job_.scene.materials[n];
    if (evaluator < 0) {
      alphas.push_back(kUnusedAlpha);
    } else {
      alphas.push_back(material.glints ? std::sqrt(material.glints->alpha.prod())
                                       : masking_alpha(*surfaces_[evaluator], material.roughness));
    }
  }
  Scene scene(job_.scene, job_.image.width, job_.image.height, job_.image.subpixels, alphas,
              {plan_.gathers_light, {}});
  scene_seconds_ = watch.seconds();
  return scene;
}

std::vector<const Surface*> BuiltJob::surfaces() const {
  std::vector<const Surface*> pointers;
  for (const std::optional<Surface>& surface : surfaces_) pointers.push_back(surface ? &*surface : nullptr);
  return pointers;
}

std::size_t BuiltJob::device_bytes() const {
  std::size_t bytes = 0;
  for (const auto& evaluator : evaluators_) bytes += evaluator->device_bytes();
  return bytes;
}

double BuiltJob::device_seconds() const {
  double seconds = 0;
  for (const auto& evaluator : evaluators_) seconds += evaluator->device_seconds();
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
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    if (queries[n].empty()) continue;
    if (built.glints(n)) {
      start_glints(n, built, queries[n]);
    } else {
      parts_[n].pending = built.evaluator(n).start(queries[n]);
    }
  }
}

void PendingBlock::start_glints(std::size_t evaluator, const BuiltJob& built,
                                const std::vector<Query>& queries) {
  Part& part = parts_[evaluator];
  std::vector<GlintPoint> points;
  points.reserve(queries.size());
  for (const std::size_t place : part.places) points.push_back(rows_.queries[place].glints);
  std::unique_ptr<GridDensities> pending = built.glints(evaluator)->start(queries, points);
  const int material = built.plan().evaluators[evaluator].glints_material;
  part.colors = built.job().scene.materials[material].glints->colors;
  if (!part.colors.empty()) part.glints = pending.get();
  part.pending = std::move(pending);
}

/// The mean colour of a query's glints goes into its weight.
void PendingBlock::tint(const Part& part, const std::vector<float>& densities) {
  for (std::size_t n = 0; n < densities.size(); ++n) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t color = 0; color < part.colors.size(); ++color)
      sum += part.colors[color] * static_cast<double>(part.glints->density_of_color(color, n));
    Eigen::Vector3f& weight = rows_.queries[part.places[n]].weight;
    if (densities[n] > 0) weight = weight.cwiseProduct((sum / densities[n]).cast<float>());
  }
}

std::vector<float> PendingBlock::wait() {
  std::vector<float> densities(rows_.queries.size());
  for (Part& part : parts_) {
    if (!part.pending) continue;
    const std::vector<float> answers = part.pending->wait();
    for (std::size_t n = 0; n < answers.size(); ++n) densities[part.places[n]] = answers[n];
    if (part.glints) tint(part, answers);
  }
  return densities;
}

}  // namespace mica
