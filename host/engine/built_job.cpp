#include "host/engine/built_job.h"

#include <fmt/format.h>

#include <cmath>

#include "host/base/stopwatch.h"
#include "host/engine/auto_evaluator.h"
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
  for (std::size_t n = 0; n < surfaces_.size(); ++n) {
    const std::string& name = plan.evaluators[n].evaluator;
    evaluators_.push_back(name == "auto" ? calibrated_evaluator(n, device)
                                         : make_evaluator(name, device, surfaces_[n]));
  }
  for (std::size_t n = 0; n < surfaces_.size() && plan.gathers_light; ++n) {
    // Of the densities, that of triangles alone is that of the surface's normals, and not an approximation.
    const auto draws = plan.evaluators[n].evaluator == "triangles" ? NdfBrdf::Draws::surface_normals
                                                                   : NdfBrdf::Draws::smooth_lobe;
    brdfs_.push_back(std::make_unique<NdfBrdf>(*evaluators_[n], surfaces_[n], draws));
  }
  build_seconds_ = watch.seconds();
}

/// `auto`, calibrated with the queries of some rows of the image.
std::unique_ptr<Evaluator> BuiltJob::calibrated_evaluator(std::size_t n, Device& device) {
  constexpr int most_rows = 24;
  constexpr std::size_t samples_a_class = 64;
  const Surface& surface = surfaces_[n];
  const int height = job_.image.height, rows = std::min(height, most_rows);
  std::vector<Query> queries;
  for (int row = 0; row < rows; ++row)
    for (const GlintQuery& glint : scene_.trace((2 * row + 1) * height / (2 * rows), 1).queries)
      if (plan_.evaluator_of_material[glint.material] == static_cast<int>(n)) queries.push_back(glint.query);
  const double tolerance = job_.accuracy.tolerance;
  auto evaluator = std::make_unique<AutoEvaluator>(device, surface, tolerance);
  evaluator->calibrate(calibration_sample(queries.size(), samples_a_class, surface.width(), surface.height(),
                                          [&](std::size_t k) { return queries[k]; }));
  for (const AutoChoice& choice : evaluator->choices())
    notes_.push_back(
        fmt::format("surface {}: auto takes {} for footprints of about {:.3g} texels: relative L2 {:.2g}, at "
                    "most {:.2g} at 95% "
                    "confidence by {} of the job's queries; tolerance {}",
                    plan_.evaluators[n].surface, choice.evaluator, std::exp2(choice.kind.size),
                    choice.relative_l2, choice.upper_bound, choice.samples, tolerance));
  return evaluator;
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
  for (std::size_t n = 0; n < job_.scene.materials.size(); ++n) {
    const int evaluator = plan_.evaluator_of_material[n];
    alphas.push_back(evaluator < 0 ? kUnusedAlpha
                                   : masking_alpha(surfaces_[evaluator], job_.scene.materials[n].roughness));
  }
  Scene scene(job_.scene, job_.image.width, job_.image.height, job_.image.subpixels, alphas,
              {plan_.gathers_light, {}});
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
