#include "host/surface/between_steps.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/surface/restore_steps.h"

namespace mica::host {
namespace {

using Complex = std::complex<float>;
using Gains = LocalFilter::Gains;

constexpr float kRounding = 1.0f / 12;
constexpr std::uint64_t kPlacesStream = 1u << 20;  // of random numbers; iterations have those before
constexpr float kLeastPower = 1e-5f;
/// Powers of rounding are guesses from few windows: what is little more than they are may be rounding, too.
constexpr float kOverSubtraction = 2;
/// Standard deviation of texels about their field, in steps. The smaller, the truer, and the slower draws
/// move.
constexpr double kNugget = 0.1;
/// Shares of white noise that Wiener's filter leaves: up to the first the mean is that of draws, from the
/// second on its own.
constexpr float kSmoothShare = 0.1f, kRoughShare = 0.2f;

template <typename Function>
PairGrid of_each(const PairGrid& grid, const Function& function) {
  PairGrid result(grid.size());
  std::transform(grid.begin(), grid.end(), result.begin(), [&](const Complex& value) {
    return Complex(function(value.real()), function(value.imag()));
  });
  return result;
}

PairGrid smoothest(int side, const PairGrid& rounded, int iterations) {
  RoundedGrid u{side, side, {}}, v{side, side, {}};
  for (const Complex& value : rounded) u.values.push_back(value.real()), v.values.push_back(value.imag());
  restore_steps(iterations, &u, &v);
  PairGrid grid(rounded.size());
  for (std::size_t n = 0; n < grid.size(); ++n) grid[n] = {u.values[n], v.values[n]};
  return grid;
}

/// Powers of what rounding takes from a surface, wherever its steps lie.
Gains rounding_powers(const LocalFilter& filter, const PairGrid& surface) {
  constexpr int places = 4;
  Gains mean;
  for (int place = 0; place < places; ++place) {
    const float shift = static_cast<float>(place) / places;
    const Gains powers =
        filter.powers(of_each(surface, [=](float x) { return std::round(x + shift) - (x + shift); }));
    if (mean.empty()) mean.resize(powers.size());
    for (std::size_t n = 0; n < powers.size(); ++n)
      for (const int axis : {0, 1}) mean[n][axis] += powers[n][axis] / places;
  }
  return mean;
}

/// @param gain (window, frequency, axis) that planes take as frequency 0.
template <typename Gain>
Gains gains_of(const LocalFilter& filter, const Gain& gain) {
  constexpr int frequencies = LocalFilter::kWindow * LocalFilter::kWindow;
  Gains gains(static_cast<std::size_t>(filter.windows()) * frequencies);
  for (std::size_t n = 0; n < gains.size(); ++n)
    for (const int axis : {0, 1}) gains[n][axis] = gain(n, n / frequencies, n % frequencies, axis);
  return gains;
}

/// A number of variance kNugget^2 about a middle, between bounds: logistic, whose quantiles are elementary.
float draw_between(float low, float high, double middle, double random) {
  const double scale = kNugget * std::sqrt(3.0) / kPi;
  const auto share_below = [&](double x) { return 1 / (1 + std::exp((middle - x) / scale)); };
  const double below = share_below(low), share = below + random * (share_below(high) - below);
  if (!(share > 0 && share < 1)) return middle < low ? low : high;
  return std::clamp(static_cast<float>(middle + scale * std::log(share / (1 - share))), low, high);
}

PairGrid white_noise(std::size_t texels, std::uint64_t seed, std::uint64_t stream) {
  PairGrid noise(texels);
  for (std::size_t n = 0; n < texels; ++n) {  // [Box and Muller 1958]
    const double radius = std::sqrt(-2 * std::log1p(-random_unit(seed, stream, 2 * n)));
    const double angle = 2 * kPi * random_unit(seed, stream, 2 * n + 1);
    noise[n] = {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))};
  }
  return noise;
}

/// Gains of fields, draws and windows.
struct Prior {
  Gains field, spread, wiener;
  std::vector<std::array<float, 2>> rough;  ///< share of Wiener's filter in the mean, of windows

  Prior(const LocalFilter& filter, const PairGrid& rounded, const PairGrid& smooth)
      : rough(static_cast<std::size_t>(filter.windows())) {
    const Gains powers = filter.powers(rounded), of_rounding = rounding_powers(filter, smooth);
    constexpr auto nugget = static_cast<float>(kNugget * kNugget);
    const auto power = [&](std::size_t n, int axis) {
      return std::max(powers[n][axis] - kOverSubtraction * of_rounding[n][axis], kLeastPower);
    };
    field = gains_of(filter, [&](std::size_t n, std::size_t, std::size_t frequency, int axis) {
      return frequency == 0 ? 1 : power(n, axis) / (power(n, axis) + nugget);
    });
    spread = gains_of(filter, [&](std::size_t n, std::size_t, std::size_t frequency, int axis) {
      return frequency == 0 ? 0 : std::sqrt(nugget * field[n][axis]);
    });
    wiener = gains_of(filter, [&](std::size_t n, std::size_t, std::size_t frequency, int axis) {
      return frequency == 0 ? 1 : power(n, axis) / (power(n, axis) + kRounding);
    });
    const std::size_t frequencies = wiener.size() / rough.size();
    for (const int axis : {0, 1})
      for (std::size_t window = 0; window < rough.size(); ++window) {
        double sum = 0;
        for (std::size_t k = 0; k < frequencies; ++k) sum += wiener[window * frequencies + k][axis];
        const auto share = static_cast<float>(sum / static_cast<double>(frequencies));
        rough[window][axis] = std::clamp((share - kSmoothShare) / (kRoughShare - kSmoothShare), 0.0f, 1.0f);
      }
  }
};

PairGrid sum_of(const PairGrid& a, const PairGrid& b, float weight_of_b = 1) {
  PairGrid sum(a.size());
  for (std::size_t n = 0; n < a.size(); ++n) sum[n] = a[n] + weight_of_b * b[n];
  return sum;
}

}  // namespace

PairGrid anywhere_between_steps(const PairGrid& rounded, std::uint64_t seed) {
  PairGrid places = rounded;
  for (std::size_t n = 0; n < places.size(); ++n) {
    const auto place = [&](std::uint64_t index) {
      return static_cast<float>(random_unit(seed, kPlacesStream, index) - 0.5);
    };
    places[n] += Complex(place(2 * n), place(2 * n + 1));
  }
  return places;
}

BetweenSteps between_steps(int side, const PairGrid& rounded, int draws, int smoothing, std::uint64_t seed) {
  const LocalFilter filter(side);
  const PairGrid smooth = smoothest(side, rounded, smoothing);
  const Prior prior(filter, rounded, smooth);
  const auto window_share = [&](std::size_t, std::size_t window, std::size_t, int axis) {
    return prior.rough[window][axis];
  };
  const Gains rough = gains_of(filter, window_share);
  BetweenSteps found;
  // Where texels are rough, any place is as good, and draws would take long to get there.
  const PairGrid anywhere = anywhere_between_steps(rounded, seed);
  found.draw = sum_of(smooth, filter.filtered(sum_of(anywhere, smooth, -1), rough));
  PairGrid sum(rounded.size());
  const int unused = draws / 3;
  for (int iteration = 0; iteration < unused + draws; ++iteration) {
    const std::uint64_t stream = 2 * static_cast<std::uint64_t>(iteration);
    const PairGrid field = sum_of(filter.filtered(found.draw, prior.field),
                                  filter.filtered(white_noise(rounded.size(), seed, stream), prior.spread));
    for (std::size_t n = 0; n < field.size(); ++n) {
      const auto between = [&](float middle, float at, std::uint64_t index) {
        return draw_between(middle - 0.5f, middle + 0.5f, at, random_unit(seed, stream + 1, index));
      };
      found.draw[n] = {between(rounded[n].real(), field[n].real(), 2 * n),
                       between(rounded[n].imag(), field[n].imag(), 2 * n + 1)};
      if (iteration >= unused) sum[n] += found.draw[n] / static_cast<float>(draws);
    }
  }
  const Gains smooth_field = gains_of(filter, [&](std::size_t n, std::size_t window, std::size_t, int axis) {
    return (1 - prior.rough[window][axis]) * prior.field[n][axis];
  });
  const Gains rough_field = gains_of(filter, [&](std::size_t n, std::size_t window, std::size_t, int axis) {
    return prior.rough[window][axis] * prior.wiener[n][axis];
  });
  found.mean = sum_of(filter.filtered(sum, smooth_field), filter.filtered(rounded, rough_field));
  for (std::size_t n = 0; n < rounded.size(); ++n) {
    const auto bounded = [](float x, float middle) { return std::clamp(x, middle - 0.5f, middle + 0.5f); };
    found.mean[n] = {bounded(found.mean[n].real(), rounded[n].real()),
                     bounded(found.mean[n].imag(), rounded[n].imag())};
  }
  return found;
}

}  // namespace mica::host
