#include "host/render/render.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/base/stopwatch.h"
#include "host/render/built_job.h"
#include "host/render/film.h"
#include "host/render/gather_light.h"
#include "host/render/luminance.h"
#include "host/render/pending_block.h"
#include "host/render/refinement.h"
#include "mica/version.h"

namespace mica::host {
namespace {

/// Offers a block's queries to the audit.
void offer(const TracedRows& rows, const std::vector<float>& densities, const Plan& plan, int width,
           AuditSampler* sampler) {
  std::vector<std::uint64_t> ordinals(rows.fitted.size(), 0);
  for (std::size_t n = 0; n < densities.size(); ++n) {
    const GlintQuery& glint = rows.queries[n];
    if (glint.pixel == GlintQuery::kNone) continue;  // its own block has it too
    const std::uint64_t pixel = static_cast<std::uint64_t>(rows.first_row) * width + glint.pixel;
    sampler->offer(pixel, ordinals[glint.pixel]++, glint.query, densities[n],
                   plan.evaluator_of_material[glint.material], glint.glints);
  }
}

/// What lamps with an extent show, and how far one Gaussian for each or for its parts is from that.
class LampsError {
 public:
  void add(const TracedRows& rows, const std::vector<float>& densities) {
    for (std::size_t n = 0; n < densities.size(); ++n) {
      const GlintQuery& glint = rows.queries[n];
      if (glint.pixel == GlintQuery::kNone) continue;
      const double light = luminance(glint.weight.cast<double>()) * static_cast<double>(densities[n]);
      all_ += light * light;
      missed_ += std::pow(light * static_cast<double>(glint.missed_by_lamp), 2);
    }
  }
  double relative_l2() const { return all_ > 0 ? std::sqrt(missed_ / all_) : 0; }

 private:
  double all_ = 0, missed_ = 0;
};

std::string describe_extent(double relative_l2) {
  return fmt::format(
      "lamps are wide beside the lobes that they light: glints are off by some {:.2g} (relative L2) for it; "
      "accuracy.lamp_parts cuts them into parts",
      relative_l2);
}

/// Offers a block's lights that are multiplied with a BRDF, as they come.
class OfferBrdfs {
 public:
  OfferBrdfs(const BuiltJob& built, int first_row, AuditSampler* sampler)
      : built_(built), first_row_(first_row), sampler_(sampler) {}

  void operator()(const LitBrdf& lit, const BrdfValue& value) {
    if (lit.pixel == GlintQuery::kNone) return;
    ordinal_ = lit.pixel == pixel_ ? ordinal_ + 1 : 0, pixel_ = lit.pixel;
    const Plan& plan = built_.plan();
    const int evaluator = plan.evaluator_of_material[lit.material];
    if (!method_of(built_.job(), plan.evaluators[static_cast<std::size_t>(evaluator)])
             .traits()
             .brdf_references)
      return;
    const std::uint64_t before =
        static_cast<std::uint64_t>(first_row_) * static_cast<std::uint64_t>(built_.job().image.width);
    sampler_->offer_brdf(before + lit.pixel, kBrdfs + ordinal_, lit.query, value.single, evaluator);
  }

 private:
  static constexpr std::uint64_t kBrdfs = std::uint64_t{1} << 32;  // ordinals beyond those of densities

  const BuiltJob& built_;
  int first_row_;
  AuditSampler* sampler_;
  std::uint32_t pixel_ = GlintQuery::kNone;
  std::uint64_t ordinal_ = 0;
};

std::vector<float> estimate_errors(const BuiltJob& built, const TracedRows& rows,
                                   const std::vector<float>& densities) {
  std::vector<float> errors(densities.size());
  tbb::parallel_for(std::size_t{0}, errors.size(), [&](std::size_t n) {
    const GlintQuery& glint = rows.queries[n];
    const auto evaluator = static_cast<std::size_t>(built.plan().evaluator_of_material[glint.material]);
    errors[n] = static_cast<float>(built.evaluator(evaluator).error_estimate(glint.query, densities[n]));
  });
  return errors;
}

/// Traces and evaluates rows; the device evaluates one block while the host traces the next.
void evaluate_rows(BuiltJob& built, const RowRange& rows, const RenderProgress& progress,
                   const TakeRows& take, AuditSampler* sampler, RenderResult* result) {
  const Stopwatch total;
  const int rows_a_block = built.plan().rows_a_block;
  const std::vector<std::string>& channels = built.plan().channels;
  const bool wants_errors = std::find(channels.begin(), channels.end(), "error.Y") != channels.end();
  const int end = rows.first + rows.count;
  Refinement refinement(built);
  LampsError lamps;
  std::optional<PendingBlock> in_flight;
  for (int row = rows.first; row < end || in_flight; row += rows_a_block) {
    std::optional<PendingBlock> next;
    if (row < end) {
      const Stopwatch tracing;
      TracedRows traced = built.take_rows(row, std::min(rows_a_block, end - row));
      result->seconds.trace += tracing.seconds();
      const Stopwatch gathering;
      result->queries += add_lit_brdfs(built, &traced, OfferBrdfs(built, traced.first_row, sampler));
      result->queries += gather_light(built, &traced);
      result->seconds.gather += gathering.seconds();
      next.emplace(std::move(traced), built);
    }
    if (in_flight) {
      const Stopwatch waiting;
      const std::vector<float> densities = in_flight->wait();
      result->seconds.wait += waiting.seconds();
      const Stopwatch refining;
      result->queries += refinement.refine(&in_flight->rows(), densities);
      result->seconds.refine += refining.seconds();
      take(in_flight->rows(), densities,
           wants_errors ? estimate_errors(built, in_flight->rows(), densities) : std::vector<float>());
      offer(in_flight->rows(), densities, built.plan(), built.job().image.width, sampler);
      lamps.add(in_flight->rows(), densities);
      result->queries += densities.size();
      result->dropped_queries += in_flight->dropped();
      progress(in_flight->rows().first_row + in_flight->rows().row_count - rows.first, rows.count);
    }
    in_flight = std::move(next);
  }
  result->refined_pixels = refinement.refined_pixels();
  result->lamps_error = lamps.relative_l2();
  result->dropped_queries += refinement.dropped_queries();
  result->seconds.render = total.seconds();
}

}  // namespace

std::map<std::string, std::string> picture_identity(const Job& job, int frame, const std::string& inputs) {
  std::map<std::string, std::string> identity;
  identity["mica:version"] = version();
  identity["mica:job"] = fmt::format("{:016x}", job.hash);
  identity["mica:seed"] = fmt::format("{}", job.seed);
  if (job.frames.given) identity["mica:frame"] = fmt::format("{}", frame);
  if (!inputs.empty()) identity["mica:inputs"] = inputs;
  return identity;
}

std::string describe(const AuditResult& audit) {
  return fmt::format("{} queries, relative L2 {:.3g}, 99th percentile {:.3g}, maximum {:.3g}", audit.samples,
                     audit.relative_l2, audit.percentile_99, audit.maximum);
}

void tell_repairs(const FilmRepairs& repairs, RenderResult* result) {
  result->repairs = repairs;
  const auto say = [&](std::size_t count, const char* what) {
    if (count > 0)
      result->surface_warnings.push_back(fmt::format("frame {}: {} {}", result->frame, count, what));
  };
  say(result->replaced_answers,
      "answers of methods were not finite: in their place are the oracle's, or 0 of a BRDF");
  say(repairs.not_finite, "values of pixels or samples were not finite in single precision: left at 0");
  say(repairs.negative, "pixels were negative: raised to 0");
}

RenderResult evaluate_frame(BuiltJob& built, int frame, const DeviceInfo& device,
                            const RenderProgress& progress, const RowRange& rows, const TakeRows& take) {
  const Stopwatch total;
  const Job& job = built.job();
  RenderResult result;
  result.frame = frame;
  result.plan = built.plan();
  double before = 0;  // seconds that building took when this began
  if (frame == built.frame()) {
    before = built.surface_seconds() + built.scene_seconds() + built.build_seconds() + built.trace_seconds();
    result.seconds.trace = built.trace_seconds();
  } else {
    built.go_to(frame);
  }
  const double device_seconds = built.device_seconds();
  const std::size_t replaced_answers = built.replaced_answers();
  AuditSampler sampler(job.seed, job.audit.samples);
  evaluate_rows(built, rows, progress, take, &sampler, &result);

  const Stopwatch auditing;
  result.audited =
      audit(sampler.samples(), built.surfaces(), [&](std::size_t n, const std::vector<BrdfQuery>& queries) {
        const PlannedEvaluator& planned = built.plan().evaluators[n];
        return method_of(job, planned)
            .brdf_references(queries, *built.surfaces()[n], settings_of(job, planned));
      });
  result.audit = audit_result(result.audited);
  result.seconds.audit = auditing.seconds();
  result.seconds.surfaces = built.surface_seconds();
  result.seconds.scene = built.scene_seconds();
  result.seconds.build = built.build_seconds();
  result.device_bytes = built.device_bytes();
  result.device_seconds = built.device_seconds() - device_seconds;
  result.replaced_answers = built.replaced_answers() - replaced_answers;
  result.precision_error = built.precision_error();
  result.surface_notes = built.notes();
  result.surface_warnings = built.warnings();
  if (result.lamps_error > 2 * job.accuracy.tolerance)
    result.surface_warnings.push_back(describe_extent(result.lamps_error));
  result.image.metadata = picture_identity(job, frame, built.inputs());
  result.image.metadata["mica:device"] = device.name;
  if (result.audit.samples) result.image.metadata["mica:audit"] = describe(result.audit);
  result.seconds.total = before + total.seconds();
  return result;
}

RenderResult render_frame(BuiltJob& built, int frame, const DeviceInfo& device,
                          const RenderProgress& progress, std::optional<RowRange> some_rows) {
  const ImageSettings& image = built.job().image;
  const RowRange rows = some_rows.value_or(RowRange{0, image.height});
  Film film(image.width, rows.count, built.plan().channels, rows.first);
  RenderResult result =
      evaluate_frame(built, frame, device, progress, rows,
                     [&](const TracedRows& block, const std::vector<float>& densities,
                         const std::vector<float>& errors) { film.add(block, densities, errors); });
  std::map<std::string, std::string> metadata = std::move(result.image.metadata);
  result.image = film.take();
  result.image.whole_height = image.height;
  tell_repairs(film.repairs(), &result);

  const Stopwatch auditing;
  result.audited_pixels = audit_pixels(built, result.image);
  result.picture_audit = picture_audit(result.audited_pixels);
  result.image.metadata = std::move(metadata);
  if (result.picture_audit.pixels)
    result.image.metadata["mica:audit.picture"] = describe(result.picture_audit);
  result.seconds.audit += auditing.seconds();
  result.seconds.total += auditing.seconds();
  return result;
}

RenderResult render(const Job& job, const Plan& plan, Device& device, const RenderProgress& progress) {
  BuiltJob built(job, plan, device);
  return render_frame(built, job.frames.first, device.info(), progress);
}

}  // namespace mica::host
