#include "host/methods/map/first_order.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/methods/map/collected_densities.h"
#include "mica/error.h"

namespace mica::host {

std::unique_ptr<PendingDensities> start_by_order(const std::vector<Query>& queries, const StartQueries& plain,
                                                 const StartQueries& first_order) {
  const auto has_more = [](const Query& query) { return query.lobe_cov || has_first_order(query); };
  if (std::none_of(queries.begin(), queries.end(), has_more)) return plain(queries);
  std::vector<Query> some[2];
  std::vector<std::size_t> places[2];
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const int order = has_first_order(queries[n]) ? 1 : 0;
    some[order].push_back(with_scalar_roughness(queries[n]));
    places[order].push_back(n);
  }
  if (some[0].empty()) return first_order(some[1]);
  if (some[1].empty()) return plain(some[0]);
  auto all = std::make_unique<CollectedDensities>(queries.size());
  all->add(plain(some[0]), std::move(places[0]));
  all->add(first_order(some[1]), std::move(places[1]));
  return all;
}

StartQueries refuse_first_order(const std::string& method) {
  return [method](const std::vector<Query>&) -> std::unique_ptr<PendingDensities> {
    throw UsageError(
        fmt::format("{} takes no turn of the half vector and no lobe that is not round", method));
  };
}

}  // namespace mica::host
