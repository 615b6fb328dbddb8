#include "host/engine/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/engine/accuracy.h"
#include "host/engine/map_query.h"
#include "host/reference/gaussian_mixture.h"
#include "host/reference/glint_grid.h"

namespace mica {
namespace {

constexpr double kPi = 3.14159265358979323846;

double lobe_peak(const Query& query) {
  return 1 / (2 * kPi * query.roughness * query.roughness);
}

Verdict to_verdict(const Accuracy& accuracy) {
  const Query& q = accuracy.worst_query;
  return {accuracy.worst, accuracy.queries,
          fmt::format("D = {} instead of {} at uv ({}, {}), half vector ({}, {}), roughness {}",
                      accuracy.worst_density, accuracy.worst_reference, q.footprint.mean_uv.x(),
                      q.footprint.mean_uv.y(), q.half_vector.x(), q.half_vector.y(), q.roughness),
          ""};
}

/// An evaluator that promises to be near a reference: its own definition in double precision.
class PromiseJudge : public Judge {
 public:
  PromiseJudge(References references, std::function<Promise(double)> promise)
      : references_(std::move(references)), promise_(std::move(promise)) {}

  double highest(const Query& query) const override { return (1 + 2e-3) * lobe_peak(query); }
  Verdict judge(Evaluator* evaluator, const Surface& surface,
                std::vector<std::vector<Query>> probes) const override {
    return to_verdict(compare(evaluator, references_, promise_, surface, std::move(probes)));
  }

 private:
  References references_;
  std::function<Promise(double)> promise_;
};

/// An evaluator that approximates the map, and promises nothing.
class ApproximationJudge : public Judge {
 public:
  explicit ApproximationJudge(const reference::Oracle& oracle) : oracle_(oracle) {}

  double highest(const Query&) const override { return std::numeric_limits<float>::max(); }
  Verdict judge(Evaluator* evaluator, const Surface&, std::vector<std::vector<Query>> probes) const override {
    constexpr double allowed = 0.01;
    Verdict verdict;
    double squares = 0, reference_squares = 0;
    for (const std::vector<Query>& probe : probes) {
      const std::vector<float> densities = evaluator->evaluate(probe);
      const std::vector<reference::OracleResult> references = oracle_.evaluate(probe);
      for (std::size_t n = 0; n < probe.size(); ++n) {
        squares += std::pow(densities[n] - references[n].density, 2);
        reference_squares += std::pow(references[n].density, 2);
      }
      verdict.queries += probe.size();
    }
    const double error = squares == 0 ? 0 : std::sqrt(squares / reference_squares);
    verdict.worst = error / allowed;
    verdict.limitation = fmt::format("approximates the map: relative L2 of {:.2g}% here", 100 * error);
    return verdict;
  }

 private:
  const reference::Oracle& oracle_;
};

/// Far wider than a period, a footprint sees every part of the map alike: one of two periods does as well, to
/// exp(-8 pi^2), and its plain sum ends.
Query without_needless_periods(Query query) {
  constexpr double wide = 2 * 2;
  const Eigen::Matrix2d& cov = query.footprint.cov_uv;
  const double smallest = 0.5 * cov.trace() - std::hypot(0.5 * (cov(0, 0) - cov(1, 1)), cov(0, 1));
  if (smallest > wide) query.footprint.cov_uv = wide * Eigen::Matrix2d::Identity();
  return query;
}

References sum_of_gaussians(const Surface& surface) {
  return [&surface](std::vector<Query> queries) {
    std::transform(queries.begin(), queries.end(), queries.begin(), without_needless_periods);
    return reference::GaussianMixture(surface, 1).evaluate(queries);
  };
}

References oracle_densities(const reference::Oracle& oracle) {
  return [&oracle](const std::vector<Query>& queries) {
    std::vector<double> densities;
    for (const reference::OracleResult& result : oracle.evaluate(queries))
      densities.push_back(result.density);
    return densities;
  };
}

class GridJudge : public Judge {
 public:
  explicit GridJudge(const GlintGrid& grid) : density_(grid.density) {
    process_.beckmann = grid.distribution == Distribution::beckmann;
    process_.alpha_x = grid.alpha_x, process_.alpha_y = grid.alpha_y;
    process_.density = grid.density, process_.stretch = grid.stretch, process_.seed = grid.seed;
  }

  double highest(const Query&) const override { return std::numeric_limits<float>::max(); }

  Verdict judge(Evaluator* evaluator, const Surface&, std::vector<std::vector<Query>> probes) const override {
    Verdict verdict;
    for (const std::vector<Query>& probe : probes) {
      const std::vector<float> densities = evaluator->evaluate(probe);
      for (std::size_t n = 0; n < probe.size(); ++n) {
        const double error = error_of(probe[n], densities[n]);
        if (!(error > verdict.worst)) continue;
        verdict.worst = error;
        verdict.worst_query =
            fmt::format("D = {} instead of {} at half vector ({}, {})", densities[n],
                        process_.density_of(probe[n]), probe[n].half_vector.x(), probe[n].half_vector.y());
        verdict.limitation = limitation_of(probe[n], error);
      }
      verdict.queries += probe.size();
    }
    return verdict;
  }

 private:
  /// In units of what is allowed. Where the footprint is a power of two of cells, the definition steps to the
  /// next level and widens the footprint by another part of a cell: rounding decides, so both sides are
  /// right.
  double error_of(const Query& query, double density) const {
    constexpr double rounding = 1e-12;
    const double smooth = process_.smooth_density(query.half_vector);
    double least = std::numeric_limits<double>::infinity();
    for (const double factor : {1.0, 1 - rounding, 1 + rounding}) {
      Query side = query;
      side.footprint.cov_uv *= factor;
      const double reference = process_.density_of(side), difference = std::abs(density - reference);
      least = std::min(least, difference == 0 ? 0 : difference / (1e-4 * reference + 1e-6 * smooth));
    }
    return least;
  }

  /// Where a float's half vector, 6e-8 apart from the next, is the limit. docs/accuracy.md, grid.
  std::string limitation_of(const Query& query, double error) const {
    constexpr double beside_the_rim = 1e-6, narrow_lobe = 5e-3;
    constexpr int narrow_cell = 12;
    if (query.half_vector.norm() > 1 - beside_the_rim)
      return fmt::format("half vectors within 1e-6 of the rim are rounded to floats: {:.3g} times the bound",
                         error);
    if (level_of(query) >= narrow_cell)
      return fmt::format("angular cells are narrower than 2^-12: {:.3g} times the bound", error);
    if (query.roughness < narrow_lobe)
      return fmt::format("lobes of glints are narrower than 5e-3: {:.3g} times the bound", error);
    return "";
  }

  /// The coarser of the two levels that answer.
  int level_of(const Query& query) const {
    const Eigen::Matrix2d& c = query.footprint.cov_uv;
    const double major2 = 0.5 * c.trace() + std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1));
    return static_cast<int>(std::max(0.5 * std::log2(64 * std::max(major2 * density_, 1e-100)), 0.0)) + 1;
  }

  double density_;
  reference::GlintProcess process_;
};

}  // namespace

std::unique_ptr<Judge> make_judge(const std::string& evaluator, const Surface& surface,
                                  const reference::Oracle& oracle) {
  if (evaluator == "triangles")
    return std::make_unique<PromiseJudge>(oracle_densities(oracle), [](double roughness) {
      return Promise{relative_bound(roughness), kPeakBound};
    });
  if (evaluator == "gaussians")
    return std::make_unique<PromiseJudge>(sum_of_gaussians(surface), [](double) {
      return Promise{1e-4, 2e-5};
    });
  return std::make_unique<ApproximationJudge>(oracle);
}

std::unique_ptr<Judge> make_grid_judge(const GlintGrid& grid) {
  return std::make_unique<GridJudge>(grid);
}

}  // namespace mica
