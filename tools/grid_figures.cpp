// The two plots of docs/grid.md, after [Kem25] Figs. 15 and 7: energy in a white furnace against roughness,
// and noise against the number of draws. Prints their numbers; grid_figures FOLDER writes grid_energy.svg and
// grid_noise.svg there.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/image/image.h"
#include "host/methods/grid/grid_brdf.h"
#include "host/reference/glint_grid.h"
#include "host/report/svg.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr double kMicroroughness = 0.02, kDensity = 1e6;
const Eigen::Vector3d kView = Eigen::Vector3d(0.5, 0, std::sqrt(0.75));

struct Curve {
  std::string name, color;
  bool dashed;
  std::vector<std::pair<double, double>> points;
};

/// Where a value lies between two others, from 0 to 1.
using Axis = std::function<double(double)>;
Axis linear(double low, double high) {
  return [=](double x) { return (x - low) / (high - low); };
}
Axis logarithmic(double low, double high) {
  return [=](double x) { return std::log(x / low) / std::log(high / low); };
}

struct Plot {
  std::string title, x_label, y_label;
  Axis x, y;
  std::vector<double> x_ticks, y_ticks;
  std::vector<Curve> curves;
};

std::string draw(const Plot& plot) {
  constexpr double width = 460, height = 300, left = 56, top = 30, right = 22, bottom = 44;
  Svg svg(width, height);
  const auto at = [&](double x, double y) {
    return std::pair(left + plot.x(x) * (width - left - right),
                     height - bottom - plot.y(y) * (height - top - bottom));
  };
  svg.rectangle(0, 0, width, height, "#ffffff");
  for (const double x : plot.x_ticks) {
    const auto [px, low] = at(x, plot.y_ticks.front());
    svg.line(px, low, px, at(x, plot.y_ticks.back()).second, "#e0e0e0", 1);
    svg.text(px, height - bottom + 14, fmt::format("{:g}", x), Anchor::middle);
  }
  for (const double y : plot.y_ticks) {
    const auto [px, py] = at(plot.x_ticks.front(), y);
    svg.line(px, py, at(plot.x_ticks.back(), y).first, py, "#e0e0e0", 1);
    svg.text(px - 6, py + 4, fmt::format("{:g}", y), Anchor::end);
  }
  double row = height - bottom - 14 * static_cast<double>(plot.curves.size()) + 6;
  for (const Curve& curve : plot.curves) {
    std::vector<std::pair<double, double>> points;
    for (const auto& [x, y] : curve.points) points.push_back(at(x, y));
    svg.polyline(points, curve.color, 1.8, curve.dashed);
    svg.line(left + 8, row - 4, left + 32, row - 4, curve.color, 1.8, curve.dashed);
    svg.text(left + 38, row, curve.name);
    row += 14;
  }
  svg.text(width / 2, 16, plot.title, Anchor::middle, 12, "#111111");
  svg.text(width / 2, height - 10, plot.x_label, Anchor::middle);
  svg.text(14, height / 2, plot.y_label, Anchor::middle, 11, "#444444", true);
  return svg.str();
}

GlintsDescription glints_of(Distribution distribution, double alpha) {
  GlintsDescription glints;
  glints.distribution = distribution;
  glints.alpha.setConstant(alpha);
  glints.density = kDensity;
  return glints;
}

reference::GlintProcess smooth_of(Distribution distribution, double alpha) {
  GlintPoint point;
  point.distribution = distribution;
  point.alpha_x = point.alpha_y = static_cast<float>(alpha);
  return reference::GlintProcess(point);
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}
  double operator()() { return random_unit(seed_, 0, counter_++); }

 private:
  std::uint64_t seed_, counter_ = 0;
};

/// A footprint of one cell somewhere on the surface.
ViewQuery view_of(Random* random) {
  ViewQuery view;
  view.view = kView, view.roughness = kMicroroughness;
  view.footprint.mean_uv = {100 * (*random)(), 100 * (*random)()};
  view.footprint.cov_uv *= 1 / kDensity;
  return view;
}

/// Draws from the smooth distribution, each with its density over directions of light.
struct SmoothDraw {
  BrdfQuery query;
  double pdf;
};
SmoothDraw smooth_draw(const ViewQuery& view, const reference::GlintProcess& process, Random* random) {
  const double radius = 0.5 * std::sqrt((*random)()), turn = 2 * kPi * (*random)();
  const Eigen::Vector2d s =
      process.from_disk(Eigen::Vector2d(0.5 + radius * std::cos(turn), 0.5 + radius * std::sin(turn)));
  const Eigen::Vector3d half(s.x(), s.y(), std::sqrt(std::max(1 - s.squaredNorm(), 0.0)));
  const double cosine = view.view.dot(half);
  const Eigen::Vector3d light = (2 * cosine * half - view.view).normalized();
  return {{view.footprint, view.view, light, view.roughness},
          cosine > 0 ? process.smooth_density(s) * half.z() / (4 * cosine) : 0};
}

double energy_of_glints(Device& device, Distribution distribution, double alpha) {
  Random random(5);
  std::vector<SampleQuery> draws(1 << 19);
  for (std::size_t n = 0; n < draws.size(); ++n) draws[n] = {view_of(&random), n};
  double sum = 0;
  for (const BrdfSample& sample : GridBrdf(device, glints_of(distribution, alpha)).sample(draws))
    sum += sample.weight_single;
  return sum / static_cast<double>(draws.size());
}

/// The energy of the smooth distribution: its D is that of a grid so dense that no glint can be told.
double energy_of_smooth(Device& device, Distribution distribution, double alpha) {
  GlintsDescription glints = glints_of(distribution, alpha);
  glints.density = 1e12;
  GridBrdf brdf(device, glints);
  const reference::GlintProcess process = smooth_of(distribution, alpha);
  Random random(7);
  std::vector<BrdfQuery> queries;
  std::vector<double> densities;
  double sum = 0;
  constexpr int count = 1 << 17;
  for (int n = 0; n < count; ++n) {
    const SmoothDraw draw = smooth_draw(view_of(&random), process, &random);
    if (!(draw.pdf > 0) || draw.query.light.z() <= 0) continue;
    queries.push_back(draw.query), densities.push_back(draw.pdf);
  }
  const std::vector<BrdfValue> values = brdf.evaluate(queries);
  for (std::size_t n = 0; n < values.size(); ++n) sum += values[n].single / densities[n];
  return sum / count;
}

Plot energy_plot(Device& device) {
  const std::vector<double> alphas = {0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};
  Plot plot{"Energy in a white furnace, seen from 30 degrees off the normal",
            "roughness",
            "energy",
            linear(0, 1),
            linear(0.3, 1.1),
            {0, 0.2, 0.4, 0.6, 0.8, 1},
            {0.3, 0.5, 0.7, 0.9, 1.1},
            {}};
  for (const Distribution distribution : {Distribution::beckmann, Distribution::trowbridge_reitz}) {
    const bool beckmann = distribution == Distribution::beckmann;
    const std::string name = beckmann ? "Beckmann" : "Trowbridge-Reitz",
                      color = beckmann ? "#0072b2" : "#d55e00";
    Curve glints{name + ", glints", color, false, {}}, smooth{name + ", smooth", color, true, {}};
    for (const double alpha : alphas) {
      glints.points.emplace_back(alpha, energy_of_glints(device, distribution, alpha));
      smooth.points.emplace_back(alpha, energy_of_smooth(device, distribution, alpha));
      fmt::print("energy, {}, roughness {}: glints {:.4f}, smooth {:.4f}\n", name, alpha,
                 glints.points.back().second, smooth.points.back().second);
    }
    plot.curves.push_back(glints), plot.curves.push_back(smooth);
  }
  return plot;
}

/// Light from all around, with soft bands.
double radiance(const Eigen::Vector3d& direction) {
  return 1 + 0.8 * std::sin(7 * direction.x() + 2) * std::sin(5 * direction.y() + 1);
}

using Estimates = std::vector<std::vector<double>>;  // by footprint, by draw

Estimates glint_estimates(GridBrdf* brdf, int footprints, int draws) {
  Estimates estimates;
  Random random(11);
  for (int f = 0; f < footprints; ++f) {
    std::vector<SampleQuery> queries(static_cast<std::size_t>(draws), {view_of(&random), 0});
    for (std::size_t n = 0; n < queries.size(); ++n) queries[n].key = random_bits(3, f, n);
    std::vector<double>& row = estimates.emplace_back();
    for (const BrdfSample& sample : brdf->sample(queries))
      row.push_back(sample.weight_single * radiance(sample.light.cast<double>()));
  }
  return estimates;
}

Estimates smooth_estimates(GridBrdf* brdf, const reference::GlintProcess& process, int footprints,
                           int draws) {
  Estimates estimates;
  Random random(11), draw_random(13);
  for (int f = 0; f < footprints; ++f) {
    const ViewQuery view = view_of(&random);
    std::vector<BrdfQuery> queries;
    std::vector<double> densities;
    for (int n = 0; n < draws; ++n) {
      const SmoothDraw draw = smooth_draw(view, process, &draw_random);
      queries.push_back(draw.query), densities.push_back(draw.pdf);
    }
    const std::vector<BrdfValue> values = brdf->evaluate(queries);
    std::vector<double>& row = estimates.emplace_back();
    for (std::size_t n = 0; n < values.size(); ++n)
      row.push_back(values[n].single > 0 ? values[n].single / densities[n] * radiance(queries[n].light) : 0);
  }
  return estimates;
}

/// Root mean square error of means of `count` draws, over footprints and over the parts of their draws.
double error_of(const Estimates& estimates, const std::vector<double>& truth, std::size_t count) {
  double squares = 0;
  std::size_t means = 0;
  for (std::size_t f = 0; f < estimates.size(); ++f) {
    for (std::size_t first = 0; first + count <= estimates[f].size(); first += count, ++means) {
      double sum = 0;
      for (std::size_t n = first; n < first + count; ++n) sum += estimates[f][n];
      squares += std::pow(sum / static_cast<double>(count) - truth[f], 2);
    }
  }
  return std::sqrt(squares / static_cast<double>(means));
}

Plot noise_plot(Device& device) {
  constexpr int footprints = 48, draws = 1 << 14, truth_draws = 1 << 16;
  constexpr double alpha = 0.3;
  Plot plot{"Noise under light from all around",
            "draws",
            "root mean square error",
            logarithmic(1, 1024),
            logarithmic(0.003, 30),
            {1, 4, 16, 64, 256, 1024},
            {0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30},
            {}};
  for (const Distribution distribution : {Distribution::beckmann, Distribution::trowbridge_reitz}) {
    const bool beckmann = distribution == Distribution::beckmann;
    const std::string name = beckmann ? "Beckmann" : "Trowbridge-Reitz",
                      color = beckmann ? "#0072b2" : "#d55e00";
    GridBrdf brdf(device, glints_of(distribution, alpha));
    std::vector<double> truth;
    double mean = 0, smooth_mean = 0;
    for (const std::vector<double>& row : glint_estimates(&brdf, footprints, truth_draws)) {
      double sum = 0;
      for (const double x : row) sum += x;
      truth.push_back(sum / truth_draws), mean += sum / truth_draws / footprints;
    }
    const Estimates ours = glint_estimates(&brdf, footprints, draws),
                    smooth = smooth_estimates(&brdf, smooth_of(distribution, alpha), footprints, draws);
    for (const auto& row : smooth)
      for (const double x : row) smooth_mean += x / draws / footprints;
    Curve curve{name + ", glints drawn", color, false, {}}, other{name + ", smooth drawn", color, true, {}};
    for (std::size_t count = 1; count <= 1024; count *= 2) {
      curve.points.emplace_back(count, error_of(ours, truth, count));
      other.points.emplace_back(count, error_of(smooth, truth, count));
      fmt::print("noise, {}, {} draws: glints {:.4f}, smooth {:.4f}, ratio {:.2f}\n", name, count,
                 curve.points.back().second, other.points.back().second,
                 other.points.back().second / curve.points.back().second);
    }
    fmt::print("mean light, {}: glints {:.4f}, smooth {:.4f}\n", name, mean, smooth_mean);
    plot.curves.push_back(curve), plot.curves.push_back(other);
  }
  return plot;
}

int run(const char* folder) {
  Device device(0);
  const Plot energy = energy_plot(device), noise = noise_plot(device);
  if (folder) {
    write_file_atomically(fmt::format("{}/grid_energy.svg", folder), draw(energy));
    write_file_atomically(fmt::format("{}/grid_noise.svg", folder), draw(noise));
  }
  return 0;
}

}  // namespace
}  // namespace mica::host::bench

int main(int argc, char** argv) {
  try {
    return mica::host::bench::run(argc > 1 ? argv[1] : nullptr);
  } catch (const mica::Error& error) {
    fmt::print(stderr, "grid_figures: {}\n", error.what());
    return 1;
  }
}
