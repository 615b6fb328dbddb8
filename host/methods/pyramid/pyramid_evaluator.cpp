#include "host/methods/pyramid/pyramid_evaluator.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numeric>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/base/stopwatch.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/map/first_order.h"
#include "host/methods/map/map_query.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/surface/texel_footprint.h"

namespace mica::host {
namespace {

/// Cells narrower than this would be more than a map has texels; so small a roughness goes to the texels.
constexpr double kNarrowestCell = 1.0 / 512;

}  // namespace

PyramidEvaluator::PyramidEvaluator(Device& device, const Surface& surface, const PyramidSettings& settings)
    : device_(device), surface_(surface), settings_(settings), store_(settings.store) {
  if (store_) return;
  store_ = std::make_shared<PyramidStore>(
      device, surface,
      settings.levels_bytes.value_or(pyramid_levels_bytes(surface.width(), surface.height())),
      settings.wave_form.value_or(device.wave_form()), settings.batch_queries);
}

/// Answers of several levels; a query's are added in the order of its levels, whatever it is sent with.
class PyramidEvaluator::BlendedDensities : public PendingDensities {
 public:
  explicit BlendedDensities(std::size_t count) : densities_(count) {}

  void add(std::unique_ptr<PendingDensities> pending, Share share) {
    parts_.push_back({std::move(pending), std::move(share)});
  }
  std::vector<float> wait() override {
    for (Part& part : parts_) {
      const std::vector<float> answers = part.pending->wait();
      tbb::parallel_for(std::size_t{0}, answers.size(), [&](std::size_t n) {
        densities_[part.share.places[n]] += part.share.weights[n] * answers[n];
      });
    }
    return std::move(densities_);
  }

 private:
  struct Part {
    std::unique_ptr<PendingDensities> pending;
    Share share;
  };
  std::vector<Part> parts_;
  std::vector<float> densities_;
};

std::unique_ptr<PendingDensities> PyramidEvaluator::start(const std::vector<Query>& queries) {
  return start_by_order(
      queries, [this](const std::vector<Query>& some) { return start(some, false); },
      [this](const std::vector<Query>& some) { return start_turned(some); });
}

/// Levels are chosen by the places that queries see, of which their half vectors pick.
std::unique_ptr<PendingDensities> PyramidEvaluator::start_turned(const std::vector<Query>& queries) {
  std::vector<Query> places(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(),
                    [&](std::size_t n) { places[n] = place_seen(queries[n]); });
  LevelsOfQueries levels = levels_of(places, false);
  auto all = std::make_unique<BlendedDensities>(queries.size());
  for (auto& [choice, share] : levels.by_level) {
    PyramidLevelBatches& batches = level(choice);
    const Culling& culled = culling(choice);
    std::vector<device_types::mica_turned_pyramid_query> sent(share.places.size());
    tbb::parallel_for(std::size_t{0}, sent.size(), [&, &choice = choice, &share = share](std::size_t n) {
      sent[n] = to_turned_pyramid_query(queries[share.places[n]], batches.shape(), surface_.interpolation(),
                                        culled.cutoff, choice.uniform);
      sent[n].pyramid.map.scale *= static_cast<float>(culled.gain);
    });
    all->add(batches.start_turned(std::move(sent)), std::move(share));
  }
  if (levels.small.empty()) return all;
  std::vector<Query> some;
  for (const std::uint32_t place : levels.small) some.push_back(queries[place]);
  const std::vector<float> ones(some.size(), 1.0f);
  all->add(texels(false)->start(some), {std::move(levels.small), ones});
  return all;
}

std::vector<float> PyramidEvaluator::count_elements(const std::vector<Query>& queries) {
  std::vector<Query> places;
  for (const Query& query : queries) places.push_back(has_first_order(query) ? place_seen(query) : query);
  return start(places, true)->wait();
}

std::unique_ptr<PendingDensities> PyramidEvaluator::start(const std::vector<Query>& queries, bool counting) {
  LevelsOfQueries levels = levels_of(queries, counting);
  auto all = std::make_unique<BlendedDensities>(queries.size());
  for (auto& [choice, share] : levels.by_level) {
    PyramidLevelBatches& batches = level(choice);
    auto sent = level_queries(queries, share.places, choice, culling(choice));
    all->add(counting ? batches.start_count(std::move(sent)) : batches.start(std::move(sent)),
             std::move(share));
  }
  if (levels.small.empty()) return all;
  std::vector<Query> some;
  for (const std::uint32_t place : levels.small) some.push_back(queries[place]);
  const std::vector<float> ones(some.size(), 1.0f);
  all->add(texels(counting)->start(some), {std::move(levels.small), ones});
  return all;
}

PyramidEvaluator::LevelsOfQueries PyramidEvaluator::levels_of(const std::vector<Query>& queries,
                                                              bool counting) {
  double last_roughness = 0;
  for (const Query& query : queries)
    if (query.roughness != last_roughness) add_levels(last_roughness = query.roughness);
  std::vector<std::optional<PyramidShares>> all(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) { all[n] = shares(queries[n]); });
  LevelsOfQueries levels;
  const auto add = [&](const PyramidChoice& choice, std::size_t n, double weight) {
    if (weight <= 0) return;
    Share& share = levels.by_level[choice];
    share.places.push_back(static_cast<std::uint32_t>(n));
    share.weights.push_back(static_cast<float>(counting ? 1 : weight));
  };
  for (std::size_t n = 0; n < queries.size(); ++n) {
    if (!all[n]) {
      levels.small.push_back(static_cast<std::uint32_t>(n));
      continue;
    }
    const auto& [choice, finer, uniform] = *all[n];
    const int cell_class = choice.cell_class;
    add({cell_class, choice.block / 2, false}, n, (1 - uniform) * finer);
    add(choice, n, (1 - uniform) * (1 - finer));
    if (uniform > 0) add({cell_class, whole_map(cell_class), true}, n, uniform);
  }
  return levels;
}

std::vector<device_types::mica_pyramid_query> PyramidEvaluator::level_queries(
    const std::vector<Query>& queries, const std::vector<std::uint32_t>& places, const PyramidChoice& choice,
    const Culling& culling) {
  const PyramidShape& shape = level(choice).shape();
  std::vector<device_types::mica_pyramid_query> result(places.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t n) {
    result[n] =
        to_pyramid_query(queries[places[n]], shape, surface_.interpolation(), culling.cutoff, choice.uniform);
    result[n].map.scale *= static_cast<float>(culling.gain);
  });
  return result;
}

/// What culling drops has one sign. On average it is put back: the gain is the factor that brings queries all
/// over the map closest to what they are with hardly any culling. Where a footprint sees few elements, as of
/// flakes, the tails that are dropped are all there is, and the cutoff is made smaller until the rest is
/// small.
PyramidEvaluator::Culling PyramidEvaluator::culling(const PyramidChoice& choice) {
  const auto found = cullings_.find(choice);
  if (found != cullings_.end()) return found->second;
  constexpr double small_cutoff_error = 1e-6, share_of_error = 0.12;
  PyramidLevelBatches& batches = level(choice);
  const Stopwatch watch;
  const std::vector<Query> queries = culling_sample(choice);
  std::vector<std::uint32_t> places(queries.size());
  std::iota(places.begin(), places.end(), 0u);
  const auto evaluate = [&](double cutoff) {
    return batches.start(level_queries(queries, places, choice, {cutoff, 1}))->wait();
  };
  const std::vector<float> complete = evaluate(cutoff_for(small_cutoff_error));
  Culling culling;
  const double cutoff_error = settings_.precision.cutoff_error;
  for (const double finer : {1.0, 0.7, 0.5, 0.35, 0.25, 0.125, 0.0625}) {
    culling.cutoff = cutoff_for(finer * cutoff_error);
    const std::vector<float> culled = evaluate(culling.cutoff);
    double product = 0, square = 0, whole = 0;
    for (std::size_t n = 0; n < queries.size(); ++n) {
      product += static_cast<double>(culled[n]) * complete[n];
      square += static_cast<double>(culled[n]) * culled[n];
      whole += static_cast<double>(complete[n]) * complete[n];
    }
    if (square > 0) culling.gain = product / square;
    const double left = whole - culling.gain * product;  // sum of squares that no gain puts back
    if (left <= std::pow(share_of_error * cutoff_error, 2) * whole) break;
  }
  build_seconds_ += watch.seconds();
  return cullings_[choice] = culling;
}

/// Queries all over the map, of the middle of the footprints and roughnesses that read this level; wider
/// footprints are uniform ones.
std::vector<Query> PyramidEvaluator::culling_sample(const PyramidChoice& choice) const {
  constexpr int samples = 512;
  const double sigma = std::min(std::sqrt(2.0) * choice.block / settings_.precision.block_ratio,
                                0.75 * std::max(surface_.width(), surface_.height()));
  const double roughness =
      std::exp2(0.25) * cell_width(choice.cell_class, settings_.precision) / settings_.precision.cell_ratio;
  std::vector<Query> queries(samples);
  for (int n = 0; n < samples; ++n) {
    const auto random = [n](std::uint64_t stream) { return random_unit(0, stream, n); };
    Query& query = queries[n];
    query.roughness = std::min(roughness, 1.0);
    query.footprint = make_footprint(surface_, {random(0), random(1)}, sigma, sigma, 0);
    const double distance = query.roughness * std::sqrt(-2 * std::log(1 - random(2))),
                 angle = 2 * kPi * random(3);
    const Eigen::Vector2d& normal =
        surface_
            .normals()[static_cast<std::size_t>(random(4) * static_cast<double>(surface_.normals().size()))];
    query.half_vector =
        (normal + distance * Eigen::Vector2d(std::cos(angle), std::sin(angle))).cwiseMax(-1).cwiseMin(1);
  }
  return queries;
}

void PyramidEvaluator::add_levels(double roughness) {
  const int cell_class = cell_class_of(roughness);
  const double width = cell_width(cell_class, settings_.precision);
  if (width < kNarrowestCell || levels_of_class_.count(cell_class) != 0) return;
  if (unmerged_classes_.count(cell_class) != 0) return;
  if (hardly_merges(surface_, width))
    unmerged_classes_.insert(cell_class);
  else
    levels_of_class_[cell_class] = store_->levels(width);
}

std::optional<PyramidShares> PyramidEvaluator::shares(const Query& query) const {
  const auto found = levels_of_class_.find(cell_class_of(query.roughness));
  if (found == levels_of_class_.end()) return std::nullopt;
  return shares_of(query, surface_.width(), surface_.height(), found->second.finest_block,
                   settings_.precision);
}

int PyramidEvaluator::whole_map(int cell_class) const {
  return whole_map_block(surface_.width(), surface_.height(), levels_of_class_.at(cell_class).finest_block);
}

std::optional<PyramidChoice> PyramidEvaluator::choose(const Query& query) {
  if (has_first_order(query)) return choose(place_seen(query));
  add_levels(query.roughness);
  const std::optional<PyramidShares> found = shares(query);
  return found ? std::optional(found->choice) : std::nullopt;
}

PyramidLevelBatches& PyramidEvaluator::level(const PyramidChoice& choice) {
  return store_->level(cell_width(choice.cell_class, settings_.precision), choice.block);
}

Evaluator* PyramidEvaluator::texels(bool counting) {
  std::unique_ptr<Evaluator>& texels = counting ? counting_texels_ : texels_;
  if (texels) return texels.get();
  TriangleSettings settings;
  settings.batch_queries = settings_.batch_queries;
  settings.wave_form = wave_form();
  settings.count_flops = counting;
  texels = std::make_unique<TriangleEvaluator>(device_, surface_, settings);
  return texels.get();
}

std::size_t PyramidEvaluator::device_bytes() const {
  return (texels_ ? texels_->device_bytes() : 0) + (settings_.store ? 0 : store_->device_bytes());
}

double PyramidEvaluator::build_seconds() const {
  return build_seconds_ + (texels_ ? texels_->build_seconds() : 0) +
         (settings_.store ? 0 : store_->build_seconds());
}

double PyramidEvaluator::device_seconds() const {
  return (texels_ ? texels_->device_seconds() : 0) + (settings_.store ? 0 : store_->device_seconds());
}

}  // namespace mica::host
