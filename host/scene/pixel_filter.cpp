#include "host/scene/pixel_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/normal_equations.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr double kGaussianReach = 3;   // standard deviations
constexpr double kLatticeSigma = 0.6;  // of subpixels: the ripple of their sum is 2 exp(-2 (0.6 pi)^2)
constexpr double kReferenceReach = 4, kReferenceSigma = 0.8;  // the same for a reference
constexpr double kLayerBoxSigma = 0.4;  // of a box: 0.5 is 8% wider than 4 subpixels of it, this one 4%
constexpr double kSubpixelSigma = 0.5;  // of FilterKind::subpixels

double gaussian(double x, double sigma) {
  return std::exp(-0.5 * x * x / (sigma * sigma)) / (sigma * std::sqrt(2 * kPi));
}

double box(double x, double width) {
  return std::abs(x) < width / 2 ? 1 / width : 0;
}

/// The four-term window of F. J. Harris, "On the Use of Windows for Harmonic Analysis with the Discrete
/// Fourier Transform", Proceedings of the IEEE 66(1), 1978, Table I: minimum 4-sample, -92 dB.
double blackman_harris(double x, double width) {
  if (std::abs(x) >= width / 2) return 0;
  const double angle = 2 * kPi * (x / width + 0.5);
  const double window =
      0.35875 - 0.48829 * std::cos(angle) + 0.14128 * std::cos(2 * angle) - 0.01168 * std::cos(3 * angle);
  return window / (0.35875 * width);
}

/// Gaussians of half a subpixel in subpixels of `width`.
double sum_over_subpixels(double x, double width) {
  const long count = std::lround(1 / width);
  double sum = 0;
  for (long n = 0; n < count; ++n)
    sum += width * gaussian(x - (static_cast<double>(n) + 0.5) * width + 0.5, kSubpixelSigma * width);
  return sum;
}

/// Integral of f over [-reach, reach], by the midpoint rule.
template <typename Function>
double integral(double reach, const Function& f) {
  constexpr int steps = 4000;
  double sum = 0;
  for (int n = 0; n < steps; ++n) sum += f(reach * ((2 * n + 1.0) / steps - 1));
  return sum * 2 * reach / steps;
}

/// Without the Gaussians that hardly count.
FilterSum without_light_parts(FilterSum sum) {
  const double least = 1e-6 * *std::max_element(sum.weights.begin(), sum.weights.end());
  double total = 0;
  for (double& weight : sum.weights) total += weight = weight < least ? 0 : weight;
  for (double& weight : sum.weights) weight /= total;
  return sum;
}

/// The least squares of `gram` w = `right` among weights that are not negative: those that would be are
/// dropped, the most negative first.
Eigen::VectorXd weights_of(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right) {
  std::vector<Eigen::Index> kept(static_cast<std::size_t>(right.size()));
  for (std::size_t n = 0; n < kept.size(); ++n) kept[n] = static_cast<Eigen::Index>(n);
  for (;;) {
    const auto size = static_cast<Eigen::Index>(kept.size());
    Eigen::MatrixXd some(size, size);
    Eigen::VectorXd some_right(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      some_right[i] = right[kept[static_cast<std::size_t>(i)]];
      for (Eigen::Index j = 0; j < size; ++j)
        some(i, j) = gram(kept[static_cast<std::size_t>(i)], kept[static_cast<std::size_t>(j)]);
    }
    const Eigen::VectorXd solved = solve_normal_equations(some, some_right);
    Eigen::Index least = 0;
    if (size == 1 || solved.minCoeff(&least) >= 0) {
      Eigen::VectorXd all = Eigen::VectorXd::Zero(right.size());
      for (Eigen::Index i = 0; i < size; ++i) all[kept[static_cast<std::size_t>(i)]] = solved[i];
      return all;
    }
    // Its mirror image goes with it, so that the sum stays as even as the filter.
    const Eigen::Index mirror = right.size() - 1 - kept[static_cast<std::size_t>(least)];
    const Eigen::Index dropped = kept[static_cast<std::size_t>(least)];
    kept.erase(
        std::remove_if(kept.begin(), kept.end(), [&](Eigen::Index n) { return n == dropped || n == mirror; }),
        kept.end());
  }
}

}  // namespace

double FilterSum::variance() const {
  double variance = sigma_pixels * sigma_pixels;
  for (std::size_t n = 0; n < weights.size(); ++n)
    variance += weights[n] * offsets_pixels[n] * offsets_pixels[n];
  return variance;
}

FilterSum fit_gaussians(double (*density)(double x, double width), double width, double reach, double sigma,
                        std::size_t count, double spacing) {
  FilterSum sum;
  sum.sigma_pixels = sigma;
  for (std::size_t n = 0; n < count; ++n)
    sum.offsets_pixels.push_back(spacing * (static_cast<double>(n) - 0.5 * static_cast<double>(count - 1)));
  const auto size = static_cast<Eigen::Index>(count);
  Eigen::MatrixXd gram(size, size);
  Eigen::VectorXd right(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const double x = sum.offsets_pixels[static_cast<std::size_t>(i)];
    right[i] = integral(reach, [&](double y) { return density(y, width) * gaussian(y - x, sigma); });
    for (Eigen::Index j = 0; j < size; ++j)
      gram(i, j) = gaussian(x - sum.offsets_pixels[static_cast<std::size_t>(j)], std::sqrt(2.0) * sigma);
  }
  const Eigen::VectorXd weights = weights_of(gram, right);
  const double total = weights.sum();
  const double square = integral(reach, [&](double y) { return density(y, width) * density(y, width); });
  const Eigen::VectorXd shares = weights / total;
  const double error2 = square - 2 * shares.dot(right) + shares.dot(gram * shares);
  sum.weights.assign(shares.data(), shares.data() + shares.size());
  sum.relative_l2 = std::sqrt(std::max(error2, 0.0) / square);
  return sum;
}

PixelFilter::PixelFilter(const FilterDescription& description) : description_(description) {
  if (description_.width == 0)
    description_.width = description.kind == FilterKind::gaussian          ? 0.5
                         : description.kind == FilterKind::blackman_harris ? 1.5
                                                                           : 1;
  if (!(std::isfinite(description_.width) && description_.width > 0))
    throw UsageError(fmt::format("pixel filter of width {}", description.width));
}

PixelFilter PixelFilter::for_reference(int subpixels) const {
  PixelFilter filter = *this;
  filter.reference_subpixels_ = subpixels;
  return filter;
}

PixelFilter PixelFilter::for_layer() const {
  PixelFilter filter = *this;
  filter.is_for_layer_ = true;
  return filter;
}

double PixelFilter::density(double offset_pixels) const {
  switch (description_.kind) {
    case FilterKind::gaussian:
      return gaussian(offset_pixels, description_.width);
    case FilterKind::blackman_harris:
      return blackman_harris(offset_pixels, description_.width);
    case FilterKind::box:
      return box(offset_pixels, description_.width);
    case FilterKind::subpixels:
      break;
  }
  return sum_over_subpixels(offset_pixels, 1.0 / (reference_subpixels_ > 0 ? reference_subpixels_ : 4));
}

double PixelFilter::reach_pixels() const {
  const bool reference = reference_subpixels_ > 0;
  if (description_.kind == FilterKind::gaussian)
    return (reference || is_for_layer_ ? kReferenceReach : kGaussianReach) * description_.width;
  if (description_.kind != FilterKind::subpixels) return description_.width / 2;
  return reference ? 0.5 + (kReferenceReach - 1) * kSubpixelSigma / reference_subpixels_ : 0.5;
}

int PixelFilter::margin_pixels() const {
  return static_cast<int>(std::max(0.0, std::ceil(reach_pixels() - 0.5 - 1e-9)));
}

FilterSum PixelFilter::on_lattice(int subpixels) const {
  const FilterSum sum = whole_lattice(subpixels);
  return reference_subpixels_ > 0 ? without_light_parts(sum) : sum;
}

FilterSum PixelFilter::whole_lattice(int subpixels) const {
  const auto count = static_cast<std::size_t>(2 * margin_pixels() + 1) * static_cast<std::size_t>(subpixels);
  const double spacing = 1.0 / subpixels, width = description_.width;
  const double sigma = (reference_subpixels_ > 0 ? kReferenceSigma : kLatticeSigma) * spacing;
  switch (description_.kind) {
    case FilterKind::gaussian:
      return fit_gaussians(gaussian, width, 6 * width, std::min(sigma, width), count, spacing);
    case FilterKind::blackman_harris:
      return fit_gaussians(blackman_harris, width, width / 2, sigma, count, spacing);
    case FilterKind::box:
      return fit_gaussians(box, width, width / 2, (is_for_layer_ ? kLayerBoxSigma : kSubpixelSigma) * spacing,
                           count, spacing);
    case FilterKind::subpixels:
      break;
  }
  if (reference_subpixels_ > 0)
    return fit_gaussians(sum_over_subpixels, 1.0 / reference_subpixels_, 1 + 1.0 / reference_subpixels_,
                         std::min(sigma, kSubpixelSigma / reference_subpixels_), count, spacing);
  FilterSum sum;
  sum.sigma_pixels = kSubpixelSigma * spacing;
  for (int n = 0; n < subpixels; ++n) {
    sum.offsets_pixels.push_back((n + 0.5) * spacing - 0.5);
    sum.weights.push_back(spacing);
  }
  return sum;
}

FilterSum PixelFilter::by_few() const {
  const double width = description_.width;
  switch (description_.kind) {
    case FilterKind::gaussian:
      return {width, {0}, {1}, 0};
    case FilterKind::blackman_harris:  // 0.23% off; one Gaussian is 2.1%, two are 0.8%
      return fit_gaussians(blackman_harris, width, width / 2, 0.16 / 1.5 * width, 3, 0.19 / 1.5 * width);
    case FilterKind::box:
      return fit_gaussians(box, width, width / 2, 0.1 * width, 4, 0.25 * width);
    case FilterKind::subpixels:
      break;
  }
  return on_lattice(4);
}

const std::vector<GaussianSplit>& gaussian_splits() {
  // For each number of parts a sigma for which the best spacing leaves 0.3 to 0.7%, and that spacing.
  struct Choice {
    std::size_t parts;
    double sigma, spacing;
  };
  static const std::vector<GaussianSplit> splits = [] {
    std::vector<GaussianSplit> made;
    for (const Choice& choice : {Choice{2, 0.9, 0.85}, Choice{3, 0.8, 0.95}, Choice{4, 0.7, 0.9},
                                 Choice{5, 0.6, 0.85}, Choice{6, 0.5, 0.8}, Choice{8, 0.4, 0.65}})
      made.push_back(
          {choice.sigma, fit_gaussians(gaussian, 1, 6, choice.sigma, choice.parts, choice.spacing)});
    return made;
  }();
  return splits;
}

}  // namespace mica::host
