#include "host/scene/lamp_samples.h"

#include <algorithm>

namespace mica::host {
namespace {

/// Where the items of each sample begin, of items in the order of their samples, and where they end.
template <typename Item>
struct OfSamples {
  std::vector<std::size_t> first, end;

  OfSamples(const std::vector<Item>& items, std::size_t samples) : first(samples, 0), end(samples, 0) {
    for (std::size_t n = 0; n < items.size(); ++n) {
      const std::uint32_t sample = items[n].sample;
      if (sample == Lattice::kNone) continue;
      if (end[sample] == 0) first[sample] = n;
      end[sample] = n + 1;
    }
  }
};

}  // namespace

void add_lamp_samples(const TracedRows& rows, const std::vector<float>& densities,
                      std::vector<Eigen::Vector3d>* radiance) {
  const auto is_empty = [](const std::vector<std::uint32_t>& lamps) { return lamps.empty(); };
  if (std::all_of(rows.sampled_lamps.begin(), rows.sampled_lamps.end(), is_empty)) return;
  const OfSamples queries(rows.queries, rows.sample_radiance.size());
  const OfSamples smooth(rows.lamp_samples, rows.sample_radiance.size());
  for (std::size_t pixel = 0; pixel < radiance->size(); ++pixel) {
    const std::vector<std::uint32_t>& lamps = rows.sampled_lamps[pixel];
    if (lamps.empty()) continue;
    const auto counts = [&](std::uint32_t light) {
      return std::binary_search(lamps.begin(), lamps.end(), light);
    };
    const int row = static_cast<int>(pixel) / rows.lattice.width;
    const int column = static_cast<int>(pixel) % rows.lattice.width;
    rows.lattice.sum(row, column, rows.lattice.all(), [&](std::size_t sample, double weight) {
      Eigen::Vector3d light = Eigen::Vector3d::Zero();
      for (std::size_t n = smooth.first[sample]; n < smooth.end[sample]; ++n)
        if (counts(rows.lamp_samples[n].light)) light += rows.lamp_samples[n].radiance.cast<double>();
      for (std::size_t n = queries.first[sample]; n < queries.end[sample]; ++n)
        if (counts(rows.queries[n].light))
          light += rows.queries[n].weight.cast<double>() * static_cast<double>(densities[n]);
      (*radiance)[pixel] += weight * light;
    });
  }
}

}  // namespace mica::host
