#include "host/reference/binning.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "host/base/random.h"
#include "host/base/symmetric_matrix.h"
#include "host/reference/query_frame.h"
#include "host/surface/interpolate.h"
#include "mica/error.h"

namespace mica::host::reference {
namespace {

/// Two independent standard normal numbers, [Box and Muller 1958].
Eigen::Vector2d standard_normals(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  constexpr double two_pi = 6.28318530717958647692;
  const double radius = std::sqrt(-2 * std::log1p(-random_unit(seed, 2 * stream, index)));
  const double angle = two_pi * random_unit(seed, 2 * stream + 1, index);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Counts of one thread; whole numbers, so their sum has no order.
class Histogram {
 public:
  explicit Histogram(const BinningSettings& settings)
      : settings_(settings), counts_(static_cast<std::size_t>(settings.bins) * settings.bins) {}

  void count(const Eigen::Vector2d& normal) {
    if (!(normal.squaredNorm() < 1)) {
      ++left_disk_;
      return;
    }
    const Eigen::Vector2d bin =
        (normal - settings_.window_center) * (0.5 * settings_.bins / settings_.window_radius) +
        Eigen::Vector2d::Constant(0.5 * settings_.bins);
    if (!(bin.minCoeff() >= 0 && bin.maxCoeff() < settings_.bins)) {
      ++outside_window_;
      return;
    }
    ++counts_[static_cast<std::size_t>(bin.y()) * settings_.bins + static_cast<std::size_t>(bin.x())];
  }

  void add_to(BinnedNdf* total) const {
    for (std::size_t k = 0; k < counts_.size(); ++k) total->counts[k] += counts_[k];
    total->outside_window += outside_window_;
    total->left_disk += left_disk_;
  }

 private:
  const BinningSettings& settings_;
  std::vector<std::uint64_t> counts_;
  std::uint64_t outside_window_ = 0, left_disk_ = 0;
};

void check(const BinningSettings& settings) {
  if (settings.bins < 1 || settings.bins > 1 << 14) {
    throw UsageError(fmt::format("binning: {} bins a side is not in [1, 16384]", settings.bins));
  }
  if (settings.samples < 1) throw UsageError("binning: no samples");
  if (!(settings.window_radius > 0 && std::isfinite(settings.window_radius) &&
        settings.window_center.allFinite())) {
    throw UsageError("binning: the window is not finite and positive");
  }
}

}  // namespace

double BinnedNdf::density(int i, int j) const {
  const double count = static_cast<double>(counts[static_cast<std::size_t>(j) * settings.bins + i]);
  return count / (static_cast<double>(settings.samples) * bin_side() * bin_side());
}

Eigen::Vector2d BinnedNdf::bin_center(int i, int j) const {
  const double half = 0.5 * settings.bins;
  return settings.window_center + bin_side() * Eigen::Vector2d(i + 0.5 - half, j + 0.5 - half);
}

BinnedNdf bin_normals(const Surface& surface, const Query& query, const BinningSettings& settings) {
  check(settings);
  const QueryFrame frame(surface, query, 0);
  const Eigen::Vector2d& mean = frame.mean_texels();
  const Eigen::Matrix2d factor = cholesky_factor(frame.cov_texels());
  const Eigen::Matrix2d lobe = cholesky_factor(lobe_covariance(query));
  const Eigen::Matrix2d turn_texels =
      query.half_vector_turn * Eigen::Vector2d(1.0 / surface.width(), 1.0 / surface.height()).asDiagonal();

  tbb::combinable<Histogram> histograms([&] { return Histogram(settings); });
  tbb::parallel_for(
      tbb::blocked_range<std::uint64_t>(0, settings.samples, 1 << 14),
      [&](const tbb::blocked_range<std::uint64_t>& range) {
        Histogram& histogram = histograms.local();
        for (std::uint64_t n = range.begin(); n < range.end(); ++n) {
          const Eigen::Vector2d offset = factor * standard_normals(settings.seed, 0, n);
          const Eigen::Vector2d perturbation = standard_normals(settings.seed, 1, n);
          histogram.count(normal_at(surface, mean + offset) - turn_texels * offset + lobe * perturbation);
        }
      });
  BinnedNdf result;
  result.settings = settings;
  result.counts.resize(static_cast<std::size_t>(settings.bins) * settings.bins);
  histograms.combine_each([&](const Histogram& histogram) { histogram.add_to(&result); });
  return result;
}

}  // namespace mica::host::reference
