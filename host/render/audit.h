#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "host/base/glints.h"
#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host {

/// A query of the job, what the device answered, and which surface it was asked of.
struct AuditSample {
  std::uint64_t key =
      0;  ///< a hash of the seed and the query's place in the image: the sample is the lowest keys
  Query query;
  float density = 0;
  int evaluator = 0;
  GlintPoint glints{};                           ///< of evaluators without a surface
  std::optional<BrdfQuery> brdf = std::nullopt;  ///< what was asked in place of `query`
};

/// A uniform random sample of a job's queries. It depends on the seed and on the queries' places in the image
/// only, so any split into batches draws the same.
class AuditSampler {
 public:
  AuditSampler(std::uint64_t seed, std::size_t samples) : seed_(seed), samples_(samples) {}

  /// @param pixel row * width + column in the image; @param ordinal of the query within its pixel.
  void offer(std::uint64_t pixel, std::uint64_t ordinal, const Query& query, float density, int evaluator,
             const GlintPoint& glints = {});

  /// Of a light that is multiplied with a patch's BRDF: its density is what single bounces would make of a
  /// density without masking, 4 (o.g) f cos, in the units of others.
  void offer_brdf(std::uint64_t pixel, std::uint64_t ordinal, const BrdfQuery& query, float single,
                  int evaluator);

  /// What was kept, by key.
  std::vector<AuditSample> samples() const;

 private:
  void offer(std::uint64_t pixel, std::uint64_t ordinal, AuditSample sample);

  std::uint64_t seed_;
  std::size_t samples_;
  std::vector<AuditSample> heap_;  // largest key first
};

/// How far densities lie from the oracle's. Errors of single queries are |D - ref| / (ref + peak / 100),
/// where peak is the largest reference: an evaluator that keeps |D - ref| <= 1e-4 ref + 1e-6 peak stays below
/// 1e-4.
struct AuditResult {
  std::size_t samples = 0;
  double relative_l2 = 0;  ///< sqrt(sum (D - ref)^2 / sum ref^2)
  double percentile_99 = 0;
  double maximum = 0;
};

/// A sample with the density that it should have had.
struct AuditedSample {
  std::uint64_t key = 0;  ///< as AuditSample
  float density = 0;
  double reference = 0;
};

/// What an evaluator's BRDF should have answered, see Method::brdf_references.
using BrdfReferences =
    std::function<std::vector<double>(std::size_t evaluator, const std::vector<BrdfQuery>& queries)>;

/// Re-evaluates the samples in double precision; `surfaces` by AuditSample::evaluator, null for `grid`, whose
/// reference is its definition.
std::vector<AuditedSample> audit(const std::vector<AuditSample>& samples,
                                 const std::vector<const Surface*>& surfaces,
                                 const BrdfReferences& brdf_references = {});

/// Sums up samples, in the order of their keys.
AuditResult audit_result(const std::vector<AuditedSample>& samples);

}  // namespace mica::host
