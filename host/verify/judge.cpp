#include "host/verify/judge.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/constants.h"
#include "host/methods/map/map_query.h"
#include "host/reference/beckmann_mixture.h"
#include "host/reference/gaussian_mixture.h"
#include "host/reference/glint_grid.h"
#include "host/verify/accuracy.h"

namespace mica::host {
namespace {

/// Of the footprint's brightest: what culling drops of a mixture, twice its cutoff, and rounding.
constexpr double kMixtureDrops = 2e-4;

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

/// A mixture: what it promises is to be its own sum, what it is asked for is the map.
class MixtureJudge : public Judge {
 public:
  MixtureJudge(std::unique_ptr<Judge> own, const reference::Oracle& oracle)
      : own_(std::move(own)), map_(oracle) {}

  double highest(const Query& query) const override { return own_->highest(query); }
  Verdict judge(Evaluator* evaluator, const Surface& surface,
                std::vector<std::vector<Query>> probes) const override {
    const Verdict own = own_->judge(evaluator, surface, probes);
    if (own.worst > 1) return own;
    Verdict map = map_.judge(evaluator, surface, std::move(probes));
    if (map.worst <= 1) return own;
    map.limitation += fmt::format("; is its own sum to {:.2g} of the bound", own.worst);
    return map;
  }

 private:
  std::unique_ptr<Judge> own_;
  ApproximationJudge map_;
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

/// Largest range of slopes in 4 x 4 texels and one more on each side: what 16 bits of a lobe's mean span.
double leaf_slopes(const Surface& surface) {
  const auto slope = [&](long i, long j) {
    const Eigen::Vector2d& s = surface.texel(i, j);
    return Eigen::Vector2d(s / std::sqrt(1 - s.squaredNorm()));
  };
  double largest = 0;
  for (long j = 0; j < surface.height(); ++j) {
    for (long i = 0; i < surface.width(); ++i) {
      Eigen::Vector2d low = slope(i, j), high = low;
      for (long n = 0; n < 36; ++n) {
        const Eigen::Vector2d other = slope(i - 1 + n % 6, j - 1 + n / 6);
        low = low.cwiseMin(other), high = high.cwiseMax(other);
      }
      largest = std::max(largest, (high - low).maxCoeff());
    }
  }
  return largest;
}

/// `beckmanns` promises to be its own sum, but for what 16-bit slopes cost: half a unit, as far down a lobe's
/// flank as it is summed.
class BeckmannJudge : public Judge {
 public:
  explicit BeckmannJudge(const Surface& surface) : mixture_(surface, 1), leaf_slopes_(leaf_slopes(surface)) {}

  double highest(const Query&) const override {
    return std::numeric_limits<float>::max();
  }  // slopes' D / cos^4
  Verdict judge(Evaluator* evaluator, const Surface& surface,
                std::vector<std::vector<Query>> probes) const override {
    constexpr double much = 0.01, steep = 0.5;
    double most_quantised = 0;
    for (const std::vector<Query>& probe : probes)
      most_quantised = std::max(most_quantised, quantised(probe.front().roughness));
    const References references = [this](const std::vector<Query>& queries) {
      std::vector<double> densities(queries.size());
      tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
        const Query query = without_needless_periods(queries[n]);
        densities[n] = reference::BeckmannMixture::density(mixture_.lobes(query.footprint, query.roughness),
                                                           query.half_vector);
      });
      return densities;
    };
    const auto promise = [this](double roughness) {
      return Promise{3e-4 + quantised(roughness), kMixtureDrops};
    };
    Verdict verdict = to_verdict(compare(evaluator, references, promise, surface, std::move(probes)));
    if (most_quantised > much)
      verdict.limitation =
          fmt::format("16 bits hold a lobe's slope to {:.2g} roughnesses here: {:.3g} times the bound",
                      most_quantised, verdict.worst);
    else if (leaf_slopes_ > steep)
      verdict.limitation = fmt::format(
          "lobes are fitted by points that are exact where slopes are quadratic, and here "
          "they run over {:.2g} in a few texels: {:.3g} times the bound",
          leaf_slopes_, verdict.worst);
    return verdict;
  }

 private:
  double quantised(double roughness) const {
    constexpr double flank = 4.3, half_unit = 0.5 / 65534;  // standard deviations, at a cutoff of 9e-5
    return flank * half_unit * leaf_slopes_ / roughness;
  }

  reference::BeckmannMixture mixture_;
  double leaf_slopes_;
};

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
    return std::make_unique<MixtureJudge>(
        std::make_unique<PromiseJudge>(sum_of_gaussians(surface),
                                       [](double) {
                                         return Promise{1e-4, kMixtureDrops};
                                       }),
        oracle);
  if (evaluator == "beckmanns")
    return std::make_unique<MixtureJudge>(std::make_unique<BeckmannJudge>(surface), oracle);
  return std::make_unique<ApproximationJudge>(oracle);
}

std::unique_ptr<Judge> make_grid_judge(const GlintGrid& grid) {
  return std::make_unique<GridJudge>(grid);
}

}  // namespace mica::host
