#include "host/reference/oracle.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "host/reference/best_first_search.h"
#include "mica/error.h"

namespace mica::host::reference {

class Oracle::Implementation {
 public:
  Implementation(const Surface& surface, double tolerance)
      : surface_(surface), tolerance_(tolerance), map_(surface), pyramid_(map_) {}

  QueryFrame frame_of(const Query& query) const { return QueryFrame(surface_, query, 0.1 * tolerance_); }

  OracleResult evaluate(const Query& query) const {
    const QueryFrame frame = frame_of(query);
    RunningIntegral integral(tolerance_, frame.effective_area());
    BestFirstSearch(map_, pyramid_, rules_, frame, &integral).run();
    const double density = frame.scale() * integral.sum();
    // What is farther than the largest q adds less than 200 effective areas of exp(-q/2).
    const double vanished =
        frame.scale() * 200 * frame.effective_area() * std::exp(-0.5 * RunningIntegral::largest_q);
    constexpr double summation = 1e-13;
    const double error =
        frame.scale() * integral.error() + density * (frame.rounding() + summation) + vanished;
    return {density, error};
  }

 private:
  const Surface& surface_;
  double tolerance_;
  CellMap map_;
  NormalPyramid pyramid_;
  TriangleRules rules_;
};

Oracle::Oracle(const Surface& surface, double tolerance) {
  if (!(tolerance >= 1e-12 && tolerance <= 0.1)) {
    throw UsageError(fmt::format("oracle: tolerance {} is not in [1e-12, 0.1]", tolerance));
  }
  implementation_ = std::make_unique<const Implementation>(surface, tolerance);
}
Oracle::~Oracle() = default;
Oracle::Oracle(Oracle&&) noexcept = default;
Oracle& Oracle::operator=(Oracle&&) noexcept = default;

OracleResult Oracle::evaluate(const Query& query) const {
  return implementation_->evaluate(query);
}

std::vector<OracleResult> Oracle::evaluate(const std::vector<Query>& queries) const {
  for (std::size_t k = 0; k < queries.size(); ++k) {
    try {
      implementation_->frame_of(queries[k]);
    } catch (const UsageError& error) {
      throw UsageError(fmt::format("query {}: {}", k, error.what()));
    }
  }
  std::vector<OracleResult> results(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(),
                    [&](std::size_t k) { results[k] = implementation_->evaluate(queries[k]); });
  return results;
}

OracleResult evaluate(const Surface& surface, const Query& query) {
  return Oracle(surface).evaluate(query);
}

std::vector<double> evaluate(const Surface& surface, const std::vector<Query>& queries) {
  std::vector<double> densities;
  densities.reserve(queries.size());
  for (const OracleResult& result : Oracle(surface).evaluate(queries)) densities.push_back(result.density);
  return densities;
}

}  // namespace mica::host::reference
