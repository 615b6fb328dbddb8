#include "host/methods/gaussians/mixture_evaluator.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "host/base/stopwatch.h"
#include "host/methods/gaussians/mixture.h"
#include "host/methods/map/first_order.h"
#include "host/methods/map/map_query.h"
#include "host/methods/map/turned_query.h"

namespace mica::host {

namespace {

std::string gaussian_options(Interpolation interpolation, const MixtureSettings& settings, bool first_order) {
  return fmt::format(
      "-DMICA_INTERPOLATION={} -DMICA_ELEMENTS={} -DMICA_COUNT_ELEMENTS={} -DMICA_FIRST_ORDER={}",
      static_cast<int>(interpolation), settings.elements, static_cast<int>(settings.count_elements),
      static_cast<int>(first_order));
}

}  // namespace

GaussianEvaluator::GaussianEvaluator(Device& device, const Surface& surface, const MixtureSettings& settings)
    : device_(device),
      settings_(settings),
      interpolation_(surface.interpolation()),
      elements_(settings.elements),
      cutoff_(cutoff_for(settings.cutoff_error)) {
  const Stopwatch watch;
  const MapStructure mixture = build_gaussian_mixture(surface, elements_);
  build_seconds_ = watch.seconds();
  batches_.emplace(device, mixture, "gaussians/gaussians", gaussian_options(interpolation_, settings, false),
                   settings.wave_form.value_or(device.wave_form()), settings.batch_queries);
}

std::unique_ptr<PendingDensities> GaussianEvaluator::start(const std::vector<Query>& queries) {
  return start_by_order(
      queries, [this](const std::vector<Query>& some) { return start_plain(some); },
      [this](const std::vector<Query>& some) { return start_turned(some); });
}

std::unique_ptr<PendingDensities> GaussianEvaluator::start_plain(const std::vector<Query>& queries) {
  std::vector<device_types::mica_mixture_query> mixture_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    mixture_queries[n] = to_mixture_query(queries[n], batches_->grid(), interpolation_, elements_, cutoff_);
  });
  return batches_->start(std::move(mixture_queries));
}

std::unique_ptr<PendingDensities> GaussianEvaluator::start_turned(const std::vector<Query>& queries) {
  if (!turned_)
    turned_.emplace(device_, batches_->grid(), batches_->structure(), batches_->device_bytes(),
                    "gaussians/gaussians", gaussian_options(interpolation_, settings_, true),
                    settings_.wave_form.value_or(device_.wave_form()), settings_.batch_queries);
  std::vector<device_types::mica_turned_mixture_query> turned_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    turned_queries[n] =
        to_turned_mixture_query(queries[n], batches_->grid(), interpolation_, elements_, cutoff_);
  });
  return turned_->start(std::move(turned_queries));
}

double GaussianEvaluator::device_seconds() const {
  return batches_->device_seconds() + (turned_ ? turned_->device_seconds() : 0);
}

}  // namespace mica::host
