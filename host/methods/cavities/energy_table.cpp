#include "host/methods/cavities/energy_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/constants.h"

namespace mica::host {
namespace {

constexpr double kReach = 6;          // standard deviations
constexpr double kFlatCosine = 1e-9;  // E_1 is as good as constant below
constexpr double kLeastAlpha = 1e-5;  // smaller ones are alike, as functions of cosine / alpha

/// Gauss-Legendre points and weights on [-1, 1], one half of them: they are symmetric.
constexpr std::array<double, 4> kNodes = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                                          0.96028985649753623};
constexpr std::array<double, 4> kWeights = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                            0.10122853629037626};

template <typename Function>
double integrate(double low, double high, const Function& f) {
  const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
  double sum = 0;
  for (std::size_t n = 0; n < kNodes.size(); ++n)
    sum += kWeights[n] * (f(middle - half * kNodes[n]) + f(middle + half * kNodes[n]));
  return half * sum;
}

/// One side of the cavities whose slope towards the view is such that it sees the area `area` of that side:
/// what leaves it, averaged over the slopes across. [Che19] Eq. 8 with r_z = 2 m_z^2 a - o_z: of a the share
/// clamp(4 m_z^2 - 2 o_z / a, 0, 1) leaves, m_z^2 = 1 / (rest + y^2).
double side_energy(double area, double rest, double cosine, double sigma) {
  if (area <= 0) return 0;
  const double all_below = 4 * area / (area + 2 * cosine) - rest;  // y^2 up to which everything leaves
  const double none_above = 2 * area / cosine - rest;              // and from which on nothing does
  if (none_above <= 0) return 0;
  const double reach = kReach * sigma;
  const double from = std::min(std::sqrt(std::max(all_below, 0.0)), reach),
               to = std::min(std::sqrt(none_above), reach);
  double sum = area * std::erf(from / (std::sqrt(2.0) * sigma));
  const auto integrand = [&](double y) {
    return (4 * area / (rest + y * y) - 2 * cosine) * std::exp(-0.5 * y * y / (sigma * sigma));
  };
  const double middle = 0.5 * (from + to), scale = 2 / (std::sqrt(2 * kPi) * sigma);  // both signs of y
  if (to > from) sum += scale * (integrate(from, middle, integrand) + integrate(middle, to, integrand));
  return sum;
}

// The table's axes. Facets are seen from one side alone where the cosine is about as small as the roughness:
// columns are fine there, along cosine / (cosine + alpha).
double alpha_at(double row) {
  const double u = row / (EnergyTable::kSide - 1) * EnergyTable::kMaxAlpha / (1 + EnergyTable::kMaxAlpha);
  return u / (1 - u);
}
double row_of(double alpha) {
  return alpha / (1 + alpha) * (1 + EnergyTable::kMaxAlpha) / EnergyTable::kMaxAlpha *
         (EnergyTable::kSide - 1);
}
double cosine_at(double column, double alpha) {
  const double v = column / (EnergyTable::kSide - 1);
  return v * alpha / (1 + alpha - v);
}
double column_of(double cosine, double alpha) {
  return std::min(cosine * (1 + alpha) / (cosine + alpha), 1.0) * (EnergyTable::kSide - 1);
}

}  // namespace

double mean_cavity_energy(double alpha, double cosine) {
  cosine = std::max(cosine, kFlatCosine);
  const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
  const double sigma = std::max(alpha, kLeastAlpha) / std::sqrt(2.0);
  const auto integrand = [&](double x) {  // slope towards the view; of both signs, which are alike
    const double towards = cosine + x * sine, away = std::max(cosine - x * sine, 0.0);
    const double leaves =
        side_energy(towards, 1 + x * x, cosine, sigma) + side_energy(away, 1 + x * x, cosine, sigma);
    return 2 * leaves / (towards + away) * std::exp(-0.5 * x * x / (sigma * sigma)) /
           (std::sqrt(2 * kPi) * sigma);
  };
  // Kinks of flat cavities: the dual's image is shadowed, does not leave, and the dual is not seen.
  const double unit = cosine / std::max(sine, 1e-12), reach = kReach * sigma;
  std::array<double, 12> cuts = {0,     unit / 3,    unit / 2,  unit,      2 * unit,    0.5 * sigma,
                                 sigma, 1.5 * sigma, 2 * sigma, 3 * sigma, 4.5 * sigma, reach};
  for (double& cut : cuts) cut = std::min(cut, reach);
  std::sort(cuts.begin(), cuts.end());
  double sum = 0;
  for (std::size_t n = 1; n < cuts.size(); ++n)
    if (cuts[n] > cuts[n - 1]) sum += integrate(cuts[n - 1], cuts[n], integrand);
  return std::clamp(sum, 0.0, 1.0);
}

EnergyTable::EnergyTable() : entries_(static_cast<std::size_t>(kSide) * kSide) {
  tbb::parallel_for(0, kSide, [this](int row) {
    const double alpha = std::max(alpha_at(row), kLeastAlpha);
    for (int column = 0; column < kSide; ++column)
      entries_[static_cast<std::size_t>(row) * kSide + column] =
          static_cast<float>(mean_cavity_energy(alpha, cosine_at(column, alpha)));
  });
}

double EnergyTable::energy(double alpha, double cosine) const {
  alpha = std::clamp(alpha, kLeastAlpha, kMaxAlpha);
  const double row = row_of(alpha), column = column_of(cosine, alpha);
  const int i = std::min(static_cast<int>(row), kSide - 2), j = std::min(static_cast<int>(column), kSide - 2);
  const double f = row - i, g = column - j;
  const float* at = entries_.data() + static_cast<std::size_t>(i) * kSide + j;
  return (1 - f) * ((1 - g) * at[0] + g * at[1]) + f * ((1 - g) * at[kSide] + g * at[kSide + 1]);
}

}  // namespace mica::host
