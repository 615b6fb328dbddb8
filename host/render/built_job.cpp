#include "host/render/built_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/base/stopwatch.h"
#include "host/job/input_files.h"
#include "host/methods/ndf_brdf.h"
#include "host/methods/shared_evaluator.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/scene/keyframes.h"
#include "host/surface/in_time.h"
#include "host/surface/map_precision.h"

namespace mica::host {
namespace {

constexpr double kUnusedAlpha = 0.1;  // of materials that no shape has
constexpr double kPixelOfPicture =
    2;  // most pixels leave out far less than the worst, and all count in the mean square

/// The normals of a map as a whole, and of its roughness.
SmoothLobe lobe_of(const Surface& surface, const Eigen::Vector2d& roughness_uv) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& s : surface.normals()) sum += s * s.transpose() / (1 - s.squaredNorm());
  Eigen::Matrix2d moments = sum / static_cast<double>(surface.normals().size());
  moments.diagonal() += roughness_uv.cwiseAbs2();
  return SmoothLobe(Distribution::beckmann, moments, SmoothLobe::Masking::smith);
}

/// Several materials may share a surface, whose lines are said once.
void append_new(const std::vector<std::string>& lines, std::vector<std::string>* all) {
  for (const std::string& line : lines)
    if (std::find(all->begin(), all->end(), line) == all->end()) all->push_back(line);
}

}  // namespace

BuiltJob::BuiltJob(const Job& job, const Plan& plan, Device& device)
    : BuiltJob(job, plan, device, job.frames.first) {}

BuiltJob::BuiltJob(const Job& job, const Plan& plan, Device& device, int frame, TraceRows trace)
    : BuiltJob(job, plan, std::vector<Device*>{&device}, frame, std::move(trace)) {}

BuiltJob::BuiltJob(const Job& job, const Plan& plan, const std::vector<Device*>& devices, int frame,
                   TraceRows trace)
    : job_(job),
      plan_(plan),
      devices_(devices),
      device_(*devices.front()),
      traces_otherwise_(trace),
      trace_(trace ? std::move(trace)
                   : [](const Scene& scene, int first_row,
                        int row_count) { return scene.trace(first_row, row_count); }),
      frame_(frame),
      inputs_(hash_of_inputs(job)),
      surface_findings_(plan.evaluators.size()),
      precision_errors_(plan.evaluators.size()),
      choices_(plan.evaluators.size()),
      surfaces_(make_surfaces()),
      scene_(make_scene()) {
  evaluators_.resize(surfaces_.size());
  brdfs_.resize(surfaces_.size());
  lit_normals_.resize(surfaces_.size());
  std::vector<std::size_t> all(surfaces_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  build_evaluators(all);
}

void BuiltJob::build_evaluators(const std::vector<std::size_t>& changed) {
  const Stopwatch watch;
  trace_seconds_ = 0;
  for (const std::size_t n : changed) build_evaluator(n);
  traced_.clear();
  for (std::optional<SomeQueries>* some : {&of_all_frames_, &of_frame_}) {
    if (*some && traced_.empty()) traced_ = std::move((*some)->blocks);
    some->reset();
  }
  build_seconds_ = watch.seconds() - trace_seconds_;
}

TracedRows BuiltJob::take_rows(int first_row, int row_count) {
  const auto found = std::find_if(traced_.begin(), traced_.end(), [&](const TracedRows& rows) {
    return rows.first_row == first_row && rows.row_count == row_count;
  });
  if (found == traced_.end()) return trace(first_row, row_count);
  TracedRows rows = std::move(*found);
  traced_.erase(found);
  return rows;
}

void BuiltJob::build_evaluator(std::size_t n) {
  const PlannedEvaluator& planned = plan_.evaluators[n];
  past_device_seconds_ += device_seconds_of(n);
  past_replaced_answers_ += replaced_answers_of(n);
  brdfs_[n].reset();  // buffers go before the new ones come
  evaluators_[n].reset();
  if (planned.asks_densities) evaluators_[n] = make_density_evaluator(n);
  const MethodTraits traits = method_of(job_, planned).traits();
  lit_normals_[n].reset();
  if (evaluators_[n] && surfaces_[n] && (traits.surface_normals || traits.chooses))
    lit_normals_[n].emplace(*surfaces_[n]);
  if (planned.patch_brdf || plan_.gathers_light) brdfs_[n] = make_brdf(n);
}

std::unique_ptr<PatchBrdf> BuiltJob::make_brdf(std::size_t n) const {
  const PlannedEvaluator& planned = plan_.evaluators[n];
  const Method& method = method_of(job_, planned);
  const MethodTraits traits = method.traits();
  if (traits.brdf) return method.make_brdf(&device_, surface(n), settings_of(job_, planned));
  const auto draws = traits.surface_normals || traits.chooses ? NdfBrdf::Draws::surface_normals
                                                              : NdfBrdf::Draws::smooth_lobe;
  return std::make_unique<NdfBrdf>(*evaluators_[n], *surfaces_[n], draws);
}

std::unique_ptr<Evaluator> BuiltJob::make_density_evaluator(std::size_t n) {
  const PlannedEvaluator& planned = plan_.evaluators[n];
  std::unique_ptr<Evaluator> evaluator =
      make_on(devices_, method_of(job_, planned), surface(n), settings_of(job_, planned));
  if (method_of(job_, planned).traits().chooses) calibrate(n, evaluator.get());
  return evaluator;
}

/// A method that chooses among others looks at the queries of some rows of the image: of all the job's
/// frames, so that a frame is the same whichever others are rendered; of this frame where the surface is
/// another in each.
void BuiltJob::calibrate(std::size_t n, Evaluator* evaluator) {
  const bool for_one_frame = moves(job_.surfaces[plan_.evaluators[n].surface_index]);
  const FrameRange frames = for_one_frame
                                ? FrameRange{frame_, 1}
                                : FrameRange{job_.frames.first, job_.frames.last - job_.frames.first + 1};
  std::optional<SomeQueries>& some = for_one_frame ? of_frame_ : of_all_frames_;
  if (!some) {
    const Stopwatch tracing;
    some = queries_of_some_rows(
        plan_, job_.image.height, frames, [&](int frame) { return scene_at(frame); }, trace_);
    if (!some->blocks.empty()) trace_seconds_ += tracing.seconds();
  }
  const std::vector<Query>& queries = some->of_evaluator[n];
  evaluator->calibrate(
      queries.size(), [&](std::size_t k) { return queries[k]; }, some->scale);
  choices_[n].clear();
  for (const AutoChoice& choice : evaluator->choices())
    choices_[n].push_back(fmt::format("surface {}: {}: {}; tolerance {}", plan_.evaluators[n].surface,
                                      evaluator->name(), words(choice), job_.accuracy.tolerance));
}

std::vector<std::string> BuiltJob::notes() const {
  std::vector<std::string> all;
  for (const Findings& findings : surface_findings_) append_new(findings.notes, &all);
  append_new(scene_.findings().notes, &all);
  for (const std::vector<std::string>& choices : choices_) append_new(choices, &all);
  return all;
}

std::vector<std::string> BuiltJob::warnings() const {
  std::vector<std::string> all;
  for (const Findings& findings : surface_findings_) append_new(findings.warnings, &all);
  append_new(scene_.findings().warnings, &all);
  return all;
}

Scene BuiltJob::scene_at(int frame) const {
  return scene_.with_view(camera_at(job_.scene, frame), lights_at(job_.scene, frame), smooth_lobes(),
                          pixels());
}

void BuiltJob::go_to(int frame) {
  frame_ = frame;
  surface_seconds_ = scene_seconds_ = build_seconds_ = 0;
  std::vector<std::size_t> changed;
  for (std::size_t n = 0; n < surfaces_.size(); ++n) {
    if (!surfaces_[n] || !moves(job_.surfaces[plan_.evaluators[n].surface_index])) continue;
    const Stopwatch making;
    surfaces_[n] = make_surface_of(n, frame);
    surface_seconds_ += making.seconds();
    changed.push_back(n);
  }
  const Stopwatch moving;
  scene_ = scene_at(frame);
  scene_seconds_ = moving.seconds();
  build_evaluators(changed);
}

double BuiltJob::least_roughness(std::size_t n) const {
  double least = 1;
  for (std::size_t m = 0; m < job_.scene.materials.size(); ++m)
    if (plan_.evaluator_of_material[m] == static_cast<int>(n))
      least = std::min(least, job_.scene.materials[m].roughness_uv().minCoeff());
  return least;
}

Surface BuiltJob::make_surface_of(std::size_t n, int frame) {
  const SurfaceDescription& description = job_.surfaces[plan_.evaluators[n].surface_index];
  SurfaceReport report;
  Surface surface = make_surface(after(description, job_.frames.seconds(frame)), &report);
  precision_errors_[n] = report_precision(surface, least_roughness(n), &report);
  const auto named = [&](std::vector<std::string> texts) {
    for (std::string& text : texts) text = fmt::format("surface {}: {}", description.name, text);
    return texts;
  };
  surface_findings_[n] = {named(report.notes), named(report.warnings)};
  return surface;
}

std::vector<std::optional<Surface>> BuiltJob::make_surfaces() {
  const Stopwatch watch;
  std::vector<std::optional<Surface>> surfaces(plan_.evaluators.size());
  for (std::size_t n = 0; n < surfaces.size(); ++n)
    if (plan_.evaluators[n].surface_index >= 0) surfaces[n] = make_surface_of(n, frame_);
  surface_seconds_ = watch.seconds();
  return surfaces;
}

std::vector<SmoothLobe> BuiltJob::smooth_lobes() const {
  std::vector<SmoothLobe> lobes;
  for (std::size_t n = 0; n < job_.scene.materials.size(); ++n) {
    const int evaluator = plan_.evaluator_of_material[n];
    const MaterialDescription& material = job_.scene.materials[n];
    if (evaluator < 0) {
      lobes.emplace_back(kUnusedAlpha);
    } else {
      lobes.push_back(material.glints ? SmoothLobe(*material.glints, material.glints->alpha)
                                      : lobe_of(*surfaces_[evaluator], material.roughness_uv()));
    }
  }
  return lobes;
}

LightGathering BuiltJob::gathering() const {
  LightGathering gathering{plan_.gathers_light, {}};
  for (std::size_t n = 0; n < job_.scene.materials.size(); ++n) {
    const int evaluator = plan_.evaluator_of_material[n];
    gathering.patch_materials.push_back(evaluator >= 0 && plan_.evaluators[evaluator].patch_brdf);
  }
  return gathering;
}

PixelSettings BuiltJob::pixels() const {
  PixelSettings pixels;
  pixels.subpixels = job_.image.subpixels;
  pixels.filter = PixelFilter(job_.image.filter);
  pixels.tolerance = kPixelOfPicture * job_.accuracy.tolerance;
  pixels.lamp_parts = LampParts::of(job_.accuracy.lamp_parts, job_.accuracy.tolerance);
  // Lights gathered from all around are many directions a sample, and no one half vector.
  const bool may_fit = job_.image.filter.kind != FilterKind::subpixels && !plan_.gathers_light;
  pixels.turns = may_fit;
  for (std::size_t n = 0; n < job_.scene.materials.size(); ++n) {
    const int evaluator = plan_.evaluator_of_material[n];
    // Glints without a map take it too, but where half vectors turn by several lobes they lose their
    // contrast.
    const bool takes = evaluator >= 0 && surfaces_[evaluator] && plan_.evaluators[evaluator].asks_densities &&
                       method_of(job_, plan_.evaluators[evaluator]).traits().first_order;
    pixels.takes_first_order.push_back(takes);
    pixels.fits = pixels.fits || (may_fit && takes);
  }
  pixels.asks_hidden = pixels.fits && pixels.subpixels > 1;  // where pixels are refined
  return pixels;
}

Scene BuiltJob::make_scene() {
  const Stopwatch watch;
  SceneDescription description = job_.scene;
  description.camera = camera_at(job_.scene, frame_);
  description.lights = lights_at(job_.scene, frame_);
  Scene scene(description, job_.image.width, job_.image.height, pixels(), smooth_lobes(), gathering());
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
  for (std::size_t n = 0; n < evaluators_.size(); ++n) {
    if (evaluators_[n]) bytes += evaluators_[n]->device_bytes();
    if (plan_.evaluators[n].patch_brdf) bytes += brdfs_[n]->device_bytes();
  }
  return bytes;
}

double BuiltJob::device_seconds_of(std::size_t n) const {
  double seconds = evaluators_[n] ? evaluators_[n]->device_seconds() : 0;
  if (plan_.evaluators[n].patch_brdf && brdfs_[n]) seconds += brdfs_[n]->device_seconds();
  return seconds;
}

double BuiltJob::device_seconds() const {
  double seconds = past_device_seconds_;
  for (std::size_t n = 0; n < evaluators_.size(); ++n) seconds += device_seconds_of(n);
  return seconds;
}

std::vector<Evaluator*> BuiltJob::evaluators() const {
  std::vector<Evaluator*> pointers;
  for (const std::unique_ptr<Evaluator>& evaluator : evaluators_) pointers.push_back(evaluator.get());
  return pointers;
}

std::unique_ptr<Evaluator> BuiltJob::make_exact_evaluator(std::size_t n) const {
  return surface(n) ? std::make_unique<TriangleEvaluator>(device_, *surface(n)) : nullptr;
}

double BuiltJob::precision_error() const {
  double largest = 0;
  for (const double error : precision_errors_) largest = std::max(largest, error);
  return largest;
}

std::size_t BuiltJob::replaced_answers() const {
  std::size_t count = past_replaced_answers_;
  for (std::size_t n = 0; n < evaluators_.size(); ++n) count += replaced_answers_of(n);
  return count;
}

std::size_t BuiltJob::replaced_answers_of(std::size_t n) const {
  return (evaluators_[n] ? evaluators_[n]->replaced() : 0) + (brdfs_[n] ? brdfs_[n]->replaced() : 0);
}

bool BuiltJob::may_answer(const GlintQuery& glint) const {
  const auto evaluator = static_cast<std::size_t>(plan_.evaluator_of_material[glint.material]);
  return !lit_normals_[evaluator] || lit_normals_[evaluator]->may_answer(glint.query);
}

}  // namespace mica::host
