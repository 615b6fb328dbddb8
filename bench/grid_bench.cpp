// `grid` at 1920x1080 with three lights: planes seen at 90 and 25 degrees, low and high roughness, both
// distributions. [Kem25] Table 3. Prints a table; with an argument, writes it as JSON to that file.
#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/measure/fma_peak.h"
#include "host/methods/grid/grid_evaluator.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr int kWidth = 1920, kHeight = 1080, kLights = 3, kRepeats = 15, kRowStep = 8;
constexpr double kElevations[2] = {90, 25};  // degrees

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

struct Row {
  double elevation, alpha, density;
  Distribution distribution;
  std::unique_ptr<GridEvaluator> evaluator;
  std::vector<double> seconds = {};  ///< seconds of the kernel alone, sorted
};

std::vector<Row> make_rows(Device& device, std::size_t queries) {
  std::vector<Row> rows;
  for (const double elevation : kElevations) {
    for (const Distribution distribution : {Distribution::beckmann, Distribution::trowbridge_reitz}) {
      for (const double alpha : {0.1, 0.6}) {
        for (const double density : {1e4, 1e8}) {
          GlintGrid grid;
          grid.distribution = distribution;
          grid.alpha_x = grid.alpha_y = alpha;
          grid.density = density;
          // One launch: the host is idle meanwhile.
          rows.push_back({elevation, alpha, density, distribution,
                          std::make_unique<GridEvaluator>(device, grid, std::nullopt, queries)});
        }
      }
    }
  }
  return rows;
}

/// All rows in turn, again and again, so that other programs on the machine disturb all of them alike.
/// @return the multiply-add peak, the best of those that were measured in between.
double measure(Device& device, std::vector<Row>* rows, const std::vector<Query> (&queries)[2]) {
  double peak = 0;
  for (int repeat = 0; repeat <= kRepeats; ++repeat) {
    peak = std::max(peak, measure_fma_peak(device));
    for (Row& row : *rows) {
      const double before = row.evaluator->device_seconds();
      row.evaluator->evaluate(queries[row.elevation == kElevations[1]]);
      if (repeat > 0) row.seconds.push_back(row.evaluator->device_seconds() - before);
    }
  }
  for (Row& row : *rows) std::sort(row.seconds.begin(), row.seconds.end());
  return peak;
}

int run(const char* json_path) {
  Device device(0);
  const std::vector<Query> queries[2] = {plane_queries(kElevations[0]), plane_queries(kElevations[1])};
  const auto count = static_cast<double>(queries[0].size());
  std::vector<Row> rows = make_rows(device, queries[0].size());
  const double peak = measure(device, &rows, queries);
  fmt::print("device {}, multiply-add peak {:.0f} GFLOP/s, {:.0f} operations an evaluation\n",
             device.info().name, 1e-9 * peak, kFlops);
  fmt::print("{:>17} {:>9} {:>9} {:>9} {:>15} {:>15} {:>9} {:>9}\n", "distribution", "elevation", "roughness",
             "density", "evaluations/s", "at best", "of peak", "ms/frame");
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  double slowest = 0, fastest = 1e300;  // seconds, medians
  for (const Row& row : rows) {
    // Other programs only ever make a launch longer: the shortest is printed too.
    const double median = row.seconds[row.seconds.size() / 2], best = count / row.seconds.front();
    slowest = std::max(slowest, median), fastest = std::min(fastest, median);
    const char* const name = row.distribution == Distribution::beckmann ? "Beckmann" : "Trowbridge-Reitz";
    fmt::print("{:>17} {:>9} {:>9} {:>9} {:>15.4g} {:>15.4g} {:>8.0f}% {:>9.2f}\n", name, row.elevation,
               row.alpha, row.density, count / median, best, 100 * best * kFlops / peak,
               1e3 * kRowStep * median);
    list.push_back({{"distribution", name},
                    {"elevation_degrees", row.elevation},
                    {"roughness", row.alpha},
                    {"density", row.density},
                    {"evaluations_per_second", count / median},
                    {"evaluations_per_second_at_best", best},
                    {"share_of_peak", best * kFlops / peak}});
  }
  fmt::print("slowest over fastest: {:.2f}\n", slowest / fastest);
  if (json_path)
    std::ofstream(json_path)
        << nlohmann::ordered_json({{"device", device.info().name}, {"rows", list}}).dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace mica::host::bench

int main(int argc, char** argv) {
  try {
    return mica::host::bench::run(argc > 1 ? argv[1] : nullptr);
  } catch (const mica::Error& error) {
    fmt::print(stderr, "grid_bench: {}\n", error.what());
    return 1;
  }
}
