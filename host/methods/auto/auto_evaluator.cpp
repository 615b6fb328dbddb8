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
#include "host/methods/pyramid/moment_pyramid.h"
#include "host/methods/pyramid/pyramid_evaluator.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr double kFirstRoughness = 0.02;

/// Fewer do not tell a bound.
constexpr std::size_t kFewestSamples = 16;
/// A candidate is judged by the first so many of a class's samples, and by more only while these cannot tell;
/// by the fewest only whether it breaks the tolerance, where there are more.
constexpr std::array<std::size_t, 5> kLooks = {kFewestSamples, 256, 1024, 4096, AutoEvaluator::kMostSamples};
/// Of the normal distribution, at 1 - 0.05 / 4: so that the bounds of all looks hold at 95%.
constexpr double kQuantile = 2.2414;
/// Seconds of a core that counting the costs of a class may take.
constexpr double kCountingSeconds = 0.1;
/// Share of what a class's queries cost by triangles that looking at them may take, and of all classes' that
/// structures may which are then not used.
constexpr double kLookingShare = 0.05;
constexpr double kExactCost = 5;  // of exact triangles, in those of a tolerance; or less

/// Share of the squared error that all classes together may have, in which those may have more than theirs
/// whose queries show next to nothing.
constexpr double kDimShare = 0.1;

/// Evaluates up to the first `end` of the queries, from where `densities` end.
void extend(Evaluator* evaluator, const std::vector<Query>& queries, std::size_t end,
            std::vector<float>* densities) {
  if (end <= densities->size()) return;
  const auto at = [&](std::size_t n) { return queries.begin() + static_cast<std::ptrdiff_t>(n); };
  const std::vector<float> more = evaluator->evaluate({at(densities->size()), at(end)});
  densities->insert(densities->end(), more.begin(), more.end());
}

}  // namespace

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
  candidates_ = candidates_for(tolerance, surface.interpolation());
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
  std::vector<Samples> classes;
  for (auto& [kind, queries] : by_class) {
    const auto count = sample.counts.find(kind);
    Samples samples{kind, std::move(queries)};
    if (count != sample.counts.end()) samples.in_job = count->second;
    samples.cost = cost(&candidates_.all[candidates_.triangles], samples.queries,
                        std::min<std::size_t>(2, samples.queries.size()));
    may_be_lost_ += kLookingShare * samples.in_job * samples.cost;
    classes.push_back(std::move(samples));
  }
  // Wide footprints first: there structures keep the tolerance most often, and one that is used is not lost.
  std::reverse(classes.begin(), classes.end());
  for (Samples& samples : classes) choices_.push_back(choose(&samples));
  take_exact_triangles(classes);
  std::sort(choices_.begin(), choices_.end(),
            [](const AutoChoice& a, const AutoChoice& b) { return a.kind < b.kind; });
  drop_what_nothing_uses();
}

void AutoEvaluator::drop_what_nothing_uses() {
  flops_counter_.reset(), elements_counter_.reset();
  for (Candidate& candidate : candidates_.all)
    if (!is_chosen(candidate)) candidate.built.reset();
  std::set<double> cell_widths;
  for (const auto& [kind, candidate] : candidate_of_)
    if (candidates_.all[candidate].kind == CandidateKind::pyramid)
      cell_widths.insert(cell_width(kind.roughness, candidates_.all[candidate].precision));
  store_->keep(cell_widths);
}

void AutoEvaluator::calibrate(std::size_t count, const QuerySource& query, double scale) {
  calibrate(calibration_sample(count, kMostSamples, surface_.width(), surface_.height(), query, scale));
}

bool AutoEvaluator::is_chosen(const Candidate& candidate) const {
  return std::any_of(candidate_of_.begin(), candidate_of_.end(),
                     [&](const auto& entry) { return &candidates_.all[entry.second] == &candidate; });
}

AutoChoice AutoEvaluator::choose(Samples* samples) {
  Candidate* const triangles = &candidates_.all[candidates_.triangles];
  AutoChoice best{samples->kind, triangles->label, 0, 0, tolerance_};  // which they promise
  best.cost = samples->cost;
  candidate_of_[samples->kind] = candidates_.triangles;
  const double worth = 1e-9 * samples->in_job * best.cost;  // seconds
  const auto affordable = [&](double seconds, double cost, std::size_t fewest, std::size_t most) {
    const double count = std::min(1e9 * seconds / cost, static_cast<double>(most));
    return std::min(std::max(static_cast<std::size_t>(count), fewest), samples->queries.size());
  };
  const double exact_cost = kExactCost * best.cost;
  if (affordable(kLookingShare * worth, exact_cost, 0, kFewestSamples) <
      std::min(kFewestSamples, samples->queries.size()))
    return best;
  samples->counted = affordable(std::min(kCountingSeconds, 0.1 * kLookingShare * worth), best.cost, 2, 64);
  if (samples->counted > 2) best.cost = cost(triangles, samples->queries, samples->counted);
  samples->most = affordable(std::min(looking_seconds_, kLookingShare * worth), exact_cost, kFewestSamples,
                             kLooks.back());
  samples->reference = &candidates_.all[candidates_.exact_triangles];
  samples->reference_error = kExactTriangles;
  extend(evaluator(samples->reference), samples->queries, std::min(kFewestSamples, samples->most),
         &samples->expected);
  const Candidate& precise = candidates_.all[candidates_.precise_pyramid];
  if (samples->most < kLooks[1] && samples->most < samples->queries.size() &&
      kLookingShare * samples->in_job * best.cost > precise.build_cost(surface_, samples->kind.roughness))
    refer_to_pyramid(samples);
  for (const CandidateKind kind : {CandidateKind::pyramid, CandidateKind::gaussians})
    choose_of(kind, samples, &best);
  if (candidate_of_[samples->kind] == candidates_.triangles) check_triangles(samples, &best);
  best.typical_density = typical_density(samples->expected);
  best.share_of_bound = share_of_bound(samples->expected, best.typical_density);
  return best;
}

void AutoEvaluator::choose_of(CandidateKind method, Samples* samples, AutoChoice* best) {
  for (std::size_t n = 0; n < candidates_.all.size() && samples->most >= kFewestSamples; ++n) {
    Candidate& candidate = candidates_.all[n];
    if (candidate.kind != method) continue;
    AutoChoice choice{samples->kind, candidate.label};
    choice.cost = best->cost;  // which is the one to beat
    const Verdict verdict = judge(&candidate, samples, &choice);
    if (verdict == Verdict::keeps) *best = choice, candidate_of_[samples->kind] = n;
    if (verdict != Verdict::breaks) break;  // the next ones of this method cost more
  }
}

void AutoEvaluator::check_triangles(Samples* samples, AutoChoice* choice) {
  const std::size_t count = std::min(kLooks[1], samples->most);
  if (count < std::min(kLooks[1], samples->queries.size())) return;  // too few to contradict a promise
  std::vector<float> densities;
  extend(evaluator(samples->reference), samples->queries, count, &samples->expected);
  extend(evaluator(&candidates_.all[candidates_.triangles]), samples->queries, samples->expected.size(),
         &densities);
  if (typical_density(samples->expected) == 0) return;  // nothing to be off from
  const SampledError error = sampled_error(densities, samples->expected, kQuantile);
  choice->samples = samples->expected.size();
  choice->relative_l2 = error.relative_l2;
  choice->upper_bound = error.upper_bound + samples->reference_error;
  if (error.relative_l2 <= tolerance_) choice->upper_bound = std::min(tolerance_, choice->upper_bound);
}

void AutoEvaluator::take_exact_triangles(const std::vector<Samples>& classes) {
  std::vector<std::pair<double, std::size_t>> broken;  // what triangles are off by, squared
  double squares = 0;                                  // of all densities
  for (std::size_t n = 0; n < classes.size(); ++n) {
    const Samples& samples = classes[n];
    const double in_job =
        std::isfinite(samples.in_job) ? samples.in_job : static_cast<double>(samples.queries.size());
    const double of_class = in_job * mean_square(samples.expected), error = choices_[n].relative_l2;
    squares += of_class;
    if (candidate_of_[samples.kind] == candidates_.triangles && error > tolerance_)
      broken.emplace_back(error * error * of_class, n);
  }
  std::sort(broken.begin(), broken.end());
  double may_be = kDimShare * tolerance_ * tolerance_ * squares;
  for (const auto& [error, n] : broken) {
    may_be -= error;
    if (may_be >= 0) continue;
    candidate_of_[classes[n].kind] = candidates_.exact_triangles;
    choices_[n].evaluator = candidates_.all[candidates_.exact_triangles].label;
    choices_[n].relative_l2 = 0, choices_[n].upper_bound = kExactTriangles;
  }
}

void AutoEvaluator::refer_to_pyramid(Samples* samples) {
  constexpr double largest_share = 0.25;  // of the tolerance
  Candidate* const precise = &candidates_.all[candidates_.precise_pyramid];
  if (samples->expected.size() < kFewestSamples || !pyramid(precise)->choose(samples->queries.front()))
    return;
  std::vector<float> densities;
  extend(evaluator(precise), samples->queries, samples->expected.size(), &densities);
  const double error = sampled_error(densities, samples->expected, kQuantile).upper_bound + kExactTriangles;
  if (error > largest_share * tolerance_) return;
  samples->reference = precise, samples->reference_error = error;
  samples->expected = std::move(densities);
  samples->most = std::min(kLooks[2], samples->queries.size());
}

AutoEvaluator::Verdict AutoEvaluator::judge(Candidate* candidate, Samples* samples, AutoChoice* choice) {
  const bool is_pyramid = candidate->kind == CandidateKind::pyramid;
  if (is_pyramid && candidate->precision.block_ratio * std::exp2(samples->kind.size + 0.5) < kFinestBlock)
    return Verdict::breaks;  // no level has blocks so small
  const CostModel model = candidate->cost_model(surface_, samples->kind.first_order);
  const int width = surface_.width(), height = surface_.height();
  const double build_cost =
      is_chosen(*candidate) ? 0 : candidate->build_cost(surface_, samples->kind.roughness);
  if (samples->in_job * choice->cost < build_cost)
    return Verdict::costs_more;  // others have answered by the time that it is built
  if (!(model.of(blocks_reached(samples->queries.front(), width, height), 0) < choice->cost))
    return Verdict::costs_more;                           // whatever would be counted
  if (build_cost > may_be_lost_) return Verdict::breaks;  // what follows may be there already
  may_be_lost_ -= build_cost;
  if (is_pyramid && !pyramid(candidate)->choose(samples->queries.front()))
    return Verdict::breaks;  // it would only pass them on to the texels
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
      may_be_lost_ += build_cost;  // it is not lost
      return Verdict::keeps;
    }
    if (error.lower_bound > tolerance_ + samples->reference_error || last) break;
  }
  return Verdict::breaks;
}

double AutoEvaluator::cost(Candidate* candidate, const std::vector<Query>& queries, std::size_t count) {
  const std::vector<Query> some(queries.begin(), queries.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<float> counts;
  if (candidate->kind == CandidateKind::pyramid) {
    counts = pyramid(candidate)->count_elements(some);
  } else if (candidate->kind == CandidateKind::gaussians) {
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
      settings.tolerance = candidate->tolerance;
      settings.count_flops = true;
      flops_counter_ = std::make_unique<TriangleEvaluator>(
          device_, static_cast<const TriangleEvaluator&>(*evaluator(candidate)), settings);
    }
    counts = flops_counter_->evaluate(some);
  }
  const CostModel model = candidate->cost_model(surface_, has_first_order(queries.front()));
  double sum = 0;
  for (std::size_t n = 0; n < some.size(); ++n)
    sum += model.of(blocks_reached(some[n], surface_.width(), surface_.height()), counts[n]);
  return sum / static_cast<double>(some.size());
}

double AutoEvaluator::error_estimate(const Query& query, double density) const {
  const QueryClass kind = class_of(query, surface_.width(), surface_.height());
  for (const AutoChoice& choice : choices_)
    if (!(choice.kind < kind) && !(kind < choice.kind))
      return choice.upper_bound * choice.share_of_bound *
             std::sqrt(density * std::max(density, choice.typical_density));
  return tolerance_ * density;  // of triangles, who answer what was not sampled
}

Evaluator* AutoEvaluator::evaluator(Candidate* candidate) {
  if (candidate->built) return candidate->built.get();
  const TriangleEvaluator* triangles = nullptr;
  for (const Candidate& other : candidates_.all)
    if (other.kind == CandidateKind::triangles && other.built)
      triangles = static_cast<const TriangleEvaluator*>(other.built.get());
  candidate->built = candidate->make(device_, surface_, store_, triangles);
  return candidate->built.get();
}

PyramidEvaluator* AutoEvaluator::pyramid(Candidate* candidate) {
  return static_cast<PyramidEvaluator*>(evaluator(candidate));
}

std::unique_ptr<PendingDensities> AutoEvaluator::start(const std::vector<Query>& queries) {
  std::vector<std::size_t> candidates(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const auto found = candidate_of_.find(class_of(queries[n], surface_.width(), surface_.height()));
    candidates[n] = found == candidate_of_.end() ? candidates_.triangles : found->second;
  });
  const bool alike =
      std::adjacent_find(candidates.begin(), candidates.end(), std::not_equal_to<>()) == candidates.end();
  if (alike && !queries.empty()) return evaluator(&candidates_.all[candidates.front()])->start(queries);
  std::vector<std::vector<std::size_t>> places_of(candidates_.all.size());
  for (std::size_t n = 0; n < queries.size(); ++n) places_of[candidates[n]].push_back(n);
  auto all = std::make_unique<CollectedDensities>(queries.size());
  for (std::size_t candidate = 0; candidate < candidates_.all.size(); ++candidate) {
    std::vector<std::size_t>& places = places_of[candidate];
    if (places.empty()) continue;
    std::vector<Query> some(places.size());
    for (std::size_t n = 0; n < places.size(); ++n) some[n] = queries[places[n]];
    all->add(evaluator(&candidates_.all[candidate])->start(some), std::move(places));
  }
  return all;
}

std::size_t AutoEvaluator::device_bytes() const {
  std::size_t bytes = store_->device_bytes();
  for (const Candidate& candidate : candidates_.all)
    if (candidate.built) bytes += candidate.built->device_bytes();
  return bytes;
}

double AutoEvaluator::build_seconds() const {
  double seconds = store_->build_seconds();
  for (const Candidate& candidate : candidates_.all)
    if (candidate.built) seconds += candidate.built->build_seconds();
  return seconds;
}

double AutoEvaluator::device_seconds() const {
  double seconds = store_->device_seconds();
  for (const Candidate& candidate : candidates_.all)
    if (candidate.built) seconds += candidate.built->device_seconds();
  return seconds;
}

}  // namespace mica::host
