#include "host/verify/accuracy.h"

#include <algorithm>
#include <cmath>

#include "host/base/random.h"
#include "host/base/symmetric_matrix.h"
#include "host/surface/interpolate.h"

namespace mica::host {
namespace {

/// Random numbers of one probe.
class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * random_unit(seed_, 0, count_++); }
  /// Box and Muller.
  Eigen::Vector2d normal() {
    const double radius = std::sqrt(-2 * std::log1p(-uniform(0, 1)));
    return radius * direction();
  }
  Eigen::Vector2d direction() {
    const double angle = uniform(0, 2 * M_PI);
    return {std::cos(angle), std::sin(angle)};
  }

 private:
  std::uint64_t seed_, count_ = 0;
};

/// The normal at a point drawn from the footprint, or at its mean.
Eigen::Vector2d normal_under(const Surface& surface, const Footprint& footprint, bool at_mean,
                             Random* random) {
  const Eigen::Matrix2d factor = cholesky_factor(footprint.cov_uv);
  Eigen::Vector2d uv = footprint.mean_uv;
  if (!at_mean) uv += factor * random->normal();
  uv -= uv.array().floor().matrix();
  return normal_at(surface, uv.cwiseProduct(Eigen::Vector2d(surface.width(), surface.height())));
}

std::vector<Query> joined(const std::vector<std::vector<Query>>& probes) {
  std::vector<Query> all;
  for (const std::vector<Query>& probe : probes) all.insert(all.end(), probe.begin(), probe.end());
  return all;
}

/// Adds to each probe a query on the brightest of the normals under its footprint.
void add_brightest(Evaluator* evaluator, const Surface& surface, std::vector<std::vector<Query>>* probes) {
  constexpr std::size_t candidates = 64;
  std::vector<Query> queries;
  for (std::size_t n = 0; n < probes->size(); ++n) {
    Random random(n);
    Query query = (*probes)[n].front();
    for (std::size_t candidate = 0; candidate < candidates; ++candidate) {
      query.half_vector = normal_under(surface, query.footprint, false, &random).cwiseMax(-1).cwiseMin(1);
      queries.push_back(query);
    }
  }
  const std::vector<float> densities = evaluator->evaluate(queries);
  for (std::size_t n = 0; n < probes->size(); ++n) {
    const auto first = densities.begin() + static_cast<long>(n * candidates);
    const auto brightest = std::max_element(first, first + candidates);
    (*probes)[n].push_back(queries[static_cast<std::size_t>(brightest - densities.begin())]);
  }
}

}  // namespace

std::vector<Query> probe(const Surface& surface, const Footprint& footprint, double roughness,
                         int half_vectors, std::uint64_t seed) {
  Random random(seed);
  std::vector<Query> queries(static_cast<std::size_t>(half_vectors),
                             Query{footprint, Eigen::Vector2d::Zero(), roughness});
  for (int n = 0; n < half_vectors; ++n) {
    const Eigen::Vector2d normal = normal_under(surface, footprint, n == 0, &random);
    const double distances[] = {0, random.uniform(1, 4), random.uniform(4, 6)};
    const Eigen::Vector2d anywhere = std::sqrt(random.uniform(0, 1)) * random.direction();
    const Eigen::Vector2d half =
        n % 4 == 3 ? anywhere : Eigen::Vector2d(normal + distances[n % 4] * roughness * random.direction());
    queries[static_cast<std::size_t>(n)].half_vector = half.cwiseMax(-1).cwiseMin(1);
  }
  return queries;
}

void Accuracy::add(const Accuracy& other) {
  const std::size_t all = queries + other.queries;
  if (other.worst > worst) *this = other;
  queries = all;
}

Accuracy compare(Evaluator* evaluator, const reference::Oracle& oracle, const Surface& surface,
                 std::vector<std::vector<Query>> probes) {
  const References densities = [&](const std::vector<Query>& queries) {
    std::vector<double> answers;
    for (const reference::OracleResult& result : oracle.evaluate(queries)) answers.push_back(result.density);
    return answers;
  };
  const auto promise = [](double roughness) { return Promise{relative_bound(roughness), kPeakBound}; };
  return compare(evaluator, densities, promise, surface, std::move(probes));
}

namespace {

/// @param error_of of a query, its density, its reference and the largest one of its footprint.
Accuracy worst_of(const std::vector<std::vector<Query>>& probes, const std::vector<float>& densities,
                  const std::vector<double>& expected,
                  const std::function<double(const Query&, double, double, double)>& error_of) {
  Accuracy accuracy;
  accuracy.queries = densities.size();
  std::size_t n = 0;
  for (const std::vector<Query>& probe : probes) {
    const auto first = expected.begin() + static_cast<long>(n);
    const double peak = *std::max_element(first, first + static_cast<long>(probe.size()));
    for (const Query& query : probe) {
      const double error = error_of(query, densities[n], expected[n], peak);
      if (error > accuracy.worst) accuracy = {densities.size(), error, query, densities[n], expected[n]};
      ++n;
    }
  }
  return accuracy;
}

}  // namespace

Accuracy compare(Evaluator* evaluator, const References& references,
                 const std::function<Promise(double roughness)>& promise, const Surface& surface,
                 std::vector<std::vector<Query>> probes) {
  add_brightest(evaluator, surface, &probes);
  const std::vector<Query> queries = joined(probes);
  const auto error_of = [&](const Query& query, double density, double reference, double peak) {
    const Promise promised = promise(query.roughness);
    const double difference = std::abs(density - reference);
    return difference == 0 ? 0 : difference / (promised.relative * reference + promised.of_peak * peak);
  };
  return worst_of(probes, evaluator->evaluate(queries), references(queries), error_of);
}

Accuracy compare(Evaluator* evaluator, const Standard& standard, const Surface& surface,
                 std::vector<std::vector<Query>> probes) {
  add_brightest(evaluator, surface, &probes);
  return compare_probes(evaluator, standard, probes);
}

Accuracy compare_probes(Evaluator* evaluator, const Standard& standard,
                        const std::vector<std::vector<Query>>& probes) {
  const std::vector<Query> queries = joined(probes);
  const auto error_of = [&](const Query& query, double density, double reference, double peak) {
    return standard.error(query, density, reference, peak);
  };
  return worst_of(probes, evaluator->evaluate(queries), standard.references(queries), error_of);
}

}  // namespace mica::host
