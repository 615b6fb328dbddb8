#include "host/methods/gaussians/mixture_evaluator.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "host/base/stopwatch.h"
#include "host/methods/gaussians/mixture.h"
#include "host/methods/map/map_query.h"

namespace mica::host {

GaussianEvaluator::GaussianEvaluator(Device& device, const Surface& surface, const MixtureSettings& settings)
    : interpolation_(surface.interpolation()),
      elements_(settings.elements),
      cutoff_(cutoff_for(settings.cutoff_error)) {
  const Stopwatch watch;
  const MapStructure mixture = build_gaussian_mixture(surface, elements_);
  build_seconds_ = watch.seconds();
  batches_.emplace(
      device, mixture, "gaussians/gaussians",
      fmt::format("-DMICA_INTERPOLATION={} -DMICA_ELEMENTS={} -DMICA_COUNT_ELEMENTS={}",
                  static_cast<int>(interpolation_), elements_, static_cast<int>(settings.count_elements)),
      settings.wave_form.value_or(device.wave_form()), settings.batch_queries);
}

std::unique_ptr<PendingDensities> GaussianEvaluator::start(const std::vector<Query>& queries) {
  std::vector<device_types::mica_mixture_query> mixture_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    mixture_queries[n] = to_mixture_query(queries[n], batches_->grid(), interpolation_, elements_, cutoff_);
  });
  return batches_->start(std::move(mixture_queries));
}

}  // namespace mica::host
