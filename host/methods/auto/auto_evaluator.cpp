#include "host/methods/auto/auto_evaluator.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "host/base/random.h"
#include "host/methods/auto/cost_model.h"
#include "host/methods/auto/sampled_error.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/map/collected_densities.h"
#include "host/methods/map/map_query.h"
#include "host/methods/pyramid/pyramid_evaluator.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr double kFirstRoughness = 0.02;
constexpr double kTrianglesError = 1e-4;  // what `triangles` are off by, at most

enum class CandidateKind { pyramid, gaussians, triangles };

/// Pyramids from the cheapest to the most precise, and the least relative L2 that was seen of each on maps
/// like those of bench/pyramid_bench.cpp: for a tolerance below it, building its levels is not worth a try.
struct PyramidCandidate {
  PyramidPrecision precision;
  double least_error;
};
const std::array<PyramidCandidate, 8> kPyramids = {{{{std::sqrt(8.0), 2, 5e-2}, 4e-3},
                                                    {{std::sqrt(8.0), 1.5, 5e-2}, 4e-3},
                                                    {{std::sqrt(2.0), 2, 5e-2}, 4e-3},
                                                    {{1.5, 2, 3e-2}, 4e-3},
                                                    {{std::sqrt(2.0), 1.5, 3e-2}, 2e-3},
                                                    {{std::sqrt(0.5), 1.5, 1e-2}, 1e-3},
                                                    {{std::sqrt(0.5), 1, 1e-3}, 1e-4},
                                                    {{std::sqrt(0.125), 0.75, 1e-4}, 0}}};

constexpr std::size_t kPrecisePyramid = 6;  // of these: precise enough to stand for `triangles`

/// Fewer do not tell a bound.
constexpr std::size_t kFewestSamples = 16;
/// A candidate is judged by the first so many of a class's samples, and by more only while these cannot tell;
/// by the fewest only whether it breaks the tolerance, where there are more.
constexpr std::array<std::size_t, 5> kLooks = {kFewestSamples, 256, 1024, 4096, AutoEvaluator::kMostSamples};
/// Of the normal distribution, at 1 - 0.05 / 4: so that the bounds of all looks hold at 95%.
constexpr double kQuantile = 2.2414;
/// Seconds of a core that counting the costs of a class may take.
constexpr double kCountingSeconds = 0.1;

/// Evaluates up to the first `end` of the queries, from where `densities` end.
void extend(Evaluator* evaluator, const std::vector<Query>& queries, std::size_t end,
            std::vector<float>* densities) {
  if (end <= densities->size()) return;
  const auto at = [&](std::size_t n) { return queries.begin() + static_cast<std::ptrdiff_t>(n); };
  const std::vector<float> more = evaluator->evaluate({at(densities->size()), at(end)});
  densities->insert(densities->end(), more.begin(), more.end());
}

double typical_density(const std::vector<float>& densities) {
  double squares = 0, sum = 0;
  for (const double density : densities) squares += density * density, sum += density;
  return sum > 0 ? squares / sum : 0;
}

}  // namespace

struct AutoEvaluator::Candidate {
  CandidateKind method;
  int elements;
  PyramidPrecision precision;
  std::string label;
  std::unique_ptr<Evaluator> built = {};

  std::unique_ptr<Evaluator> make(Device& device, const Surface& surface,
                                  const std::shared_ptr<PyramidStore>& store) const {
    if (method == CandidateKind::triangles) return std::make_unique<TriangleEvaluator>(device, surface);
    if (method == CandidateKind::gaussians) {
      MixtureSettings settings;
      settings.elements = elements;
      return std::make_unique<GaussianEvaluator>(device, surface, settings);
    }
    PyramidSettings settings;
    settings.precision = precision;
    settings.store = store;
    return std::make_unique<PyramidEvaluator>(device, surface, settings);
  }

  CostModel cost_model(const Surface& surface) const {
    if (method == CandidateKind::triangles) return triangles_cost(surface.interpolation());
    return method == CandidateKind::gaussians ? gaussians_cost(elements) : pyramid_cost();
  }
};

AutoEvaluator::AutoEvaluator(Device& device, const Surface& surface, double tolerance, double looking_seconds)
    : device_(device),
      surface_(surface),
      tolerance_(tolerance),
      looking_seconds_(looking_seconds),
      store_(std::make_shared<PyramidStore>(device, surface,
                                            pyramid_levels_bytes(surface.width(), surface.height()),
                                            device.wave_form(), PyramidSettings{}.batch_queries)) {
  if (!(tolerance >= kLeastTolerance))
    throw UsageError(
        fmt::format("tolerance {}: auto keeps {} or more; for less use triangles (1e-4) or reference",
                    tolerance, kLeastTolerance));
  // Of each method from the cheapest to the most precise.
  for (std::size_t n = 0; n < kPyramids.size(); ++n) {
    const auto& [precision, least_error] = kPyramids[n];
    if (n == kPrecisePyramid) precise_pyramid_ = candidates_.size();
    if (tolerance > least_error)
      candidates_.push_back({CandidateKind::pyramid, 0, precision,
                             fmt::format("pyramid, blocks of {:.2g} footprints, cells of {:.2g} roughnesses",
                                         precision.block_ratio, precision.cell_ratio)});
  }
  if (surface.interpolation() != Interpolation::bicubic)
    for (const int elements : {1, 2, 4})
      candidates_.push_back(
          {CandidateKind::gaussians, elements, {}, fmt::format("gaussians, {} a texel and axis", elements)});
  candidates_.push_back({CandidateKind::triangles, 0, {}, "triangles"});
}
AutoEvaluator::~AutoEvaluator() = default;

QueryClass class_of(const Query& query, int map_width, int map_height) {
  constexpr double slack = 1e-9;
  const bool first_order = has_first_order(query);
  const Query seen = first_order ? place_seen(query) : with_scalar_roughness(query);
  const FootprintAxes axes = footprint_axes(without_needless_periods(seen.footprint), map_width, map_height);
  return {static_cast<int>(std::floor(0.5 + std::log2(axes.sigma_minor_texels) + slack)),
          static_cast<int>(std::floor(2 * std::log2(seen.roughness / kFirstRoughness) + slack)), first_order};
}

CalibrationSample calibration_sample(std::size_t count, std::size_t each, int map_width, int map_height,
                                     const std::function<Query(std::size_t)>& query, double scale) {
  std::map<QueryClass, std::vector<std::pair<double, std::size_t>>> kept;  // heaps, largest key first
  CalibrationSample sample;
  for (std::size_t n = 0; n < count; ++n) {
    const Query one = query(n);
    const QueryClass kind = class_of(one, map_width, map_height);
    sample.counts[kind] += scale;
    auto& heap = kept[kind];
    const std::pair<double, std::size_t> entry(random_unit(9, 0, n), n);
    if (heap.size() == each) {
      if (!(entry < heap.front())) continue;
      std::pop_heap(heap.begin(), heap.end());
      heap.pop_back();
    }
    heap.push_back(entry);
    std::push_heap(heap.begin(), heap.end());
  }
  for (auto& [kind, heap] : kept) {
    std::sort(heap.begin(), heap.end());
    for (const auto& entry : heap) sample.queries.push_back(query(entry.second));
  }
  return sample;
}

void AutoEvaluator::calibrate(const CalibrationSample& sample) {
  std::map<QueryClass, std::vector<Query>> by_class;
  for (const Query& query : sample.queries)
    by_class[class_of(query, surface_.width(), surface_.height())].push_back(query);
  for (const auto& [kind, queries] : by_class) {
    const auto count = sample.counts.find(kind);
    const double many = std::numeric_limits<double>::infinity();
    choices_.push_back(choose(kind, {queries, count == sample.counts.end() ? many : count->second}));
  }
  // What nothing uses is not kept.
  flops_counter_.reset(), elements_counter_.reset();
  for (Candidate& candidate : candidates_)
    if (!is_chosen(candidate)) candidate.built.reset();
  std::set<double> cell_widths;
  for (const auto& [kind, candidate] : candidate_of_)
    if (candidates_[candidate].method == CandidateKind::pyramid)
      cell_widths.insert(cell_width(kind.roughness, candidates_[candidate].precision));
  store_->keep(cell_widths);
}

void AutoEvaluator::calibrate(std::size_t count, const QuerySource& query, double scale) {
  calibrate(calibration_sample(count, kMostSamples, surface_.width(), surface_.height(), query, scale));
}

double AutoEvaluator::build_cost(const Candidate& candidate) const {
  return candidate.cost_model(surface_).texel * surface_.width() * surface_.height();
}

bool AutoEvaluator::is_chosen(const Candidate& candidate) const {
  return std::any_of(candidate_of_.begin(), candidate_of_.end(),
                     [&](const auto& entry) { return &candidates_[entry.second] == &candidate; });
}

AutoChoice AutoEvaluator::choose(const QueryClass& kind, Samples samples) {
  Candidate* const triangles = &candidates_.back();
  AutoChoice best{kind, triangles->label, 0, 0, kTrianglesError};
  best.cost = cost(triangles, samples.queries, std::min<std::size_t>(2, samples.queries.size()));
  const auto affordable = [&](double seconds, std::size_t fewest, std::size_t most) {
    return std::min(std::clamp(static_cast<std::size_t>(1e9 * seconds / best.cost), fewest, most),
                    samples.queries.size());
  };
  samples.counted = affordable(kCountingSeconds, 2, 64);
  if (samples.counted > 2) best.cost = cost(triangles, samples.queries, samples.counted);
  samples.most = affordable(looking_seconds_, kFewestSamples, kLooks.back());
  samples.reference = triangles, samples.reference_error = kTrianglesError;
  extend(evaluator(triangles), samples.queries, std::min(kFewestSamples, samples.most), &samples.expected);
  if (samples.most < kLooks[1] && samples.most < samples.queries.size() &&
      samples.in_job * best.cost > build_cost(candidates_[precise_pyramid_]))
    refer_to_pyramid(&samples);
  candidate_of_[kind] = candidates_.size() - 1;
  for (const CandidateKind method : {CandidateKind::pyramid, CandidateKind::gaussians}) {
    for (std::size_t n = 0; n + 1 < candidates_.size() && samples.most >= kFewestSamples; ++n) {
      if (candidates_[n].method != method) continue;
      AutoChoice choice{kind, candidates_[n].label};
      choice.cost = best.cost;  // which is the one to beat
      const Verdict verdict = judge(&candidates_[n], &samples, &choice);
      if (verdict == Verdict::keeps) best = choice, candidate_of_[kind] = n;
      if (verdict != Verdict::breaks) break;  // the next ones of this method cost more
    }
  }
  best.samples = best.samples == 0 ? samples.expected.size() : best.samples;
  best.typical_density = typical_density(samples.expected);
  return best;
}

void AutoEvaluator::refer_to_pyramid(Samples* samples) {
  constexpr double largest_share = 0.25;  // of the tolerance
  Candidate* const precise = &candidates_[precise_pyramid_];
  if (samples->expected.size() < kFewestSamples || !pyramid(precise)->choose(samples->queries.front()))
    return;
  std::vector<float> densities;
  extend(evaluator(precise), samples->queries, samples->expected.size(), &densities);
  const double error = sampled_error(densities, samples->expected, kQuantile).upper_bound + kTrianglesError;
  if (error > largest_share * tolerance_) return;
  samples->reference = precise, samples->reference_error = error;
  samples->expected = std::move(densities);
  samples->most = std::min(kLooks[2], samples->queries.size());
}

AutoEvaluator::Verdict AutoEvaluator::judge(Candidate* candidate, Samples* samples, AutoChoice* choice) {
  if (candidate->method == CandidateKind::pyramid && !pyramid(candidate)->choose(samples->queries.front()))
    return Verdict::breaks;  // it would only pass them on to the texels
  const CostModel model = candidate->cost_model(surface_);
  const int width = surface_.width(), height = surface_.height();
  if (!is_chosen(*candidate) && samples->in_job * choice->cost < build_cost(*candidate))
    return Verdict::costs_more;  // others have answered by the time that it is built
  if (!(model.of(blocks_reached(samples->queries.front(), width, height), 0) < choice->cost))
    return Verdict::costs_more;  // whatever would be counted
  const double cost_of_query = cost(candidate, samples->queries, samples->counted);
  if (!(cost_of_query < choice->cost)) return Verdict::costs_more;
  Evaluator* const built = evaluator(candidate);
  std::vector<float> densities;
  for (const std::size_t look : kLooks) {
    const std::size_t count = std::min(look, samples->most);
    extend(evaluator(samples->reference), samples->queries, count, &samples->expected);
    extend(built, samples->queries, count, &densities);
    const SampledError error = sampled_error(
        densities,
        {samples->expected.begin(), samples->expected.begin() + static_cast<std::ptrdiff_t>(count)},
        kQuantile);
    const bool last = count == samples->most;
    const double upper_bound = error.upper_bound + samples->reference_error;
    if ((look > kFewestSamples || last) && upper_bound <= tolerance_) {
      choice->samples = count, choice->cost = cost_of_query;
      choice->relative_l2 = error.relative_l2;
      choice->upper_bound = upper_bound;
      return Verdict::keeps;
    }
    if (error.lower_bound > tolerance_ + samples->reference_error || last) break;
  }
  return Verdict::breaks;
}

double AutoEvaluator::cost(Candidate* candidate, const std::vector<Query>& queries, std::size_t count) {
  const std::vector<Query> some(queries.begin(), queries.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<float> counts;
  if (candidate->method == CandidateKind::pyramid) {
    counts = pyramid(candidate)->count_elements(some);
  } else if (candidate->method == CandidateKind::gaussians) {
    if (!elements_counter_) {
      MixtureSettings settings;
      settings.elements = kCountedMixture;
      settings.count_elements = true;
      elements_counter_ = std::make_unique<GaussianEvaluator>(device_, surface_, settings);
    }
    counts = elements_counter_->evaluate(some);
  } else {
    if (!flops_counter_) {
      TriangleSettings settings;
      settings.count_flops = true;
      flops_counter_ = std::make_unique<TriangleEvaluator>(device_, surface_, settings);
    }
    counts = flops_counter_->evaluate(some);
  }
  const CostModel model = candidate->cost_model(surface_);
  double sum = 0;
  for (std::size_t n = 0; n < some.size(); ++n)
    sum += model.of(blocks_reached(some[n], surface_.width(), surface_.height()), counts[n]);
  return sum / static_cast<double>(some.size());
}

double AutoEvaluator::error_estimate(const Query& query, double density) const {
  const QueryClass kind = class_of(query, surface_.width(), surface_.height());
  for (const AutoChoice& choice : choices_)
    if (!(choice.kind < kind) && !(kind < choice.kind))
      return choice.upper_bound * std::sqrt(density * std::max(density, choice.typical_density));
  return kTrianglesError * density;  // which is who answers what was not sampled
}

Evaluator* AutoEvaluator::evaluator(Candidate* candidate) {
  if (!candidate->built) candidate->built = candidate->make(device_, surface_, store_);
  return candidate->built.get();
}

PyramidEvaluator* AutoEvaluator::pyramid(Candidate* candidate) {
  return static_cast<PyramidEvaluator*>(evaluator(candidate));
}

std::unique_ptr<PendingDensities> AutoEvaluator::start(const std::vector<Query>& queries) {
  std::vector<std::size_t> candidates(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const auto found = candidate_of_.find(class_of(queries[n], surface_.width(), surface_.height()));
    candidates[n] = found == candidate_of_.end() ? candidates_.size() - 1 : found->second;
  });
  const bool alike =
      std::adjacent_find(candidates.begin(), candidates.end(), std::not_equal_to<>()) == candidates.end();
  if (alike && !queries.empty()) return evaluator(&candidates_[candidates.front()])->start(queries);
  std::vector<std::vector<std::size_t>> places_of(candidates_.size());
  for (std::size_t n = 0; n < queries.size(); ++n) places_of[candidates[n]].push_back(n);
  auto all = std::make_unique<CollectedDensities>(queries.size());
  for (std::size_t candidate = 0; candidate < candidates_.size(); ++candidate) {
    std::vector<std::size_t>& places = places_of[candidate];
    if (places.empty()) continue;
    std::vector<Query> some(places.size());
    for (std::size_t n = 0; n < places.size(); ++n) some[n] = queries[places[n]];
    all->add(evaluator(&candidates_[candidate])->start(some), std::move(places));
  }
  return all;
}

std::size_t AutoEvaluator::device_bytes() const {
  std::size_t bytes = store_->device_bytes();
  for (const Candidate& candidate : candidates_)
    if (candidate.built) bytes += candidate.built->device_bytes();
  return bytes;
}

double AutoEvaluator::build_seconds() const {
  double seconds = store_->build_seconds();
  for (const Candidate& candidate : candidates_)
    if (candidate.built) seconds += candidate.built->build_seconds();
  return seconds;
}

double AutoEvaluator::device_seconds() const {
  double seconds = store_->device_seconds();
  for (const Candidate& candidate : candidates_)
    if (candidate.built) seconds += candidate.built->device_seconds();
  return seconds;
}

}  // namespace mica::host
