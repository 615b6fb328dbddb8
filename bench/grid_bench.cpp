// `grid` at 1920x1080 with three lights: planes seen at 90 and 25 degrees, low and high roughness, both
// distributions. [Kem25] Table 3. Prints a table; with an argument, writes it as JSON to that file.
#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/bench/fma_peak.h"
#include "host/engine/grid_evaluator.h"

namespace mica::bench {
namespace {

constexpr int kWidth = 1920, kHeight = 1080, kLights = 3, kRepeats = 31, kRowStep = 8;

// Operations on floats of one evaluation, a multiply-add counted as two; hashes are integers and not counted.
// A glint: place 8, whitened distances 8, exponent 7, distance to the rim 5, roulette 15, exponential 11,
// sum 2. A level: twelve shares of a Gaussian 426, scale and cells 65. The map T: 40.
constexpr double kFlops = 2 * (16 * 56 + 491) + 40;

/// A pinhole camera above a plane of uv, one query a pixel and light. @param elevation of the line of sight,
/// degrees.
std::vector<Query> plane_queries(double elevation_degrees) {
  const double elevation = elevation_degrees * 3.14159265358979 / 180;
  const Eigen::Vector3d forward(0, std::cos(elevation), -std::sin(elevation)), right(1, 0, 0);
  const Eigen::Vector3d up = right.cross(forward), eye = -3 * forward;
  const Eigen::Vector3d lights[kLights] = {{1, 1, 4}, {-2, 1, 3}, {0, 3, 3}};
  const double pixel = 0.5 / kHeight;
  const auto hit = [&](double x, double y) {
    const Eigen::Vector3d ray = forward + pixel * ((x - kWidth / 2) * right + (kHeight / 2 - y) * up);
    return Eigen::Vector3d(eye - eye.z() / ray.z() * ray);
  };
  std::vector<Query> queries;
  for (int y = 0; y < kHeight; y += kRowStep) {
    for (int x = 0; x < kWidth; ++x) {
      const Eigen::Vector3d p = hit(x, y);
      Query query;
      query.roughness = 0.02;
      query.footprint.mean_uv = p.head<2>();
      Eigen::Matrix2d differentials;
      differentials << (hit(x + 1, y) - p).head<2>(), (hit(x, y + 1) - p).head<2>();
      query.footprint.cov_uv = 0.25 * differentials * differentials.transpose();
      for (const Eigen::Vector3d& light : lights) {
        query.half_vector = ((light - p).normalized() + (eye - p).normalized()).normalized().head<2>();
        queries.push_back(query);
      }
    }
  }
  return queries;
}

/// Of the kernel alone. Other programs on the machine only ever make a launch longer: the shortest is printed
/// too.
struct Seconds {
  double median, shortest;
};
Seconds device_seconds(GridEvaluator* evaluator, const std::vector<Query>& queries) {
  std::vector<double> seconds;
  for (int repeat = 0; repeat <= kRepeats; ++repeat) {
    const double before = evaluator->device_seconds();
    evaluator->evaluate(queries);
    if (repeat > 0) seconds.push_back(evaluator->device_seconds() - before);
  }
  std::sort(seconds.begin(), seconds.end());
  return {seconds[seconds.size() / 2], seconds.front()};
}

int run(const char* json_path) {
  Device device(0);
  const double peak = measure_fma_peak(device);
  fmt::print("device {}, multiply-add peak {:.0f} GFLOP/s, {:.0f} operations an evaluation\n",
             device.info().name, 1e-9 * peak, kFlops);
  fmt::print("{:>17} {:>9} {:>9} {:>9} {:>15} {:>15} {:>9} {:>9}\n", "distribution", "elevation", "roughness",
             "density", "evaluations/s", "at best", "of peak", "ms/frame");
  double slowest = 1e300, fastest = 0;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const double elevation : {90.0, 25.0}) {
    const std::vector<Query> queries = plane_queries(elevation);
    for (const Distribution distribution : {Distribution::beckmann, Distribution::trowbridge_reitz}) {
      for (const double alpha : {0.1, 0.6}) {
        for (const double density : {1e4, 1e8}) {
          GlintGrid grid;
          grid.distribution = distribution;
          grid.alpha_x = grid.alpha_y = alpha;
          grid.density = density;
          GridEvaluator evaluator(device, grid, {},
                                  queries.size());  // one launch: the host is idle meanwhile
          const Seconds seconds = device_seconds(&evaluator, queries);
          const double rate = static_cast<double>(queries.size()) / seconds.median,
                       best = static_cast<double>(queries.size()) / seconds.shortest;
          slowest = std::min(slowest, best), fastest = std::max(fastest, best);
          const char* const name = distribution == Distribution::beckmann ? "Beckmann" : "Trowbridge-Reitz";
          fmt::print("{:>17} {:>9} {:>9} {:>9} {:>15.4g} {:>15.4g} {:>8.0f}% {:>9.2f}\n", name, elevation,
                     alpha, density, rate, best, 100 * best * kFlops / peak, 1e3 * kRowStep * seconds.median);
          rows.push_back({{"distribution", name},
                          {"elevation_degrees", elevation},
                          {"roughness", alpha},
                          {"density", density},
                          {"evaluations_per_second", rate},
                          {"evaluations_per_second_at_best", best},
                          {"share_of_peak", best * kFlops / peak}});
        }
      }
    }
  }
  fmt::print("fastest over slowest, at best: {:.2f}\n", fastest / slowest);
  if (json_path)
    std::ofstream(json_path)
        << nlohmann::ordered_json({{"device", device.info().name}, {"rows", rows}}).dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace mica::bench

int main(int argc, char** argv) {
  try {
    return mica::bench::run(argc > 1 ? argv[1] : nullptr);
  } catch (const mica::Error& error) {
    fmt::print(stderr, "grid_bench: {}\n", error.what());
    return static_cast<int>(error.code());
  }
}
