#include "host/methods/auto/candidate.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/pyramid/pyramid_evaluator.h"
#include "host/methods/triangles/triangle_evaluator.h"

namespace mica::host {
namespace {

/// Pyramids from the cheapest to the most precise, and the least relative L2 that was seen of each on maps
/// like those of bench/pyramid_bench.cpp: for a tolerance below it, building its levels is not worth a try.
struct KnownPyramid {
  PyramidPrecision precision;
  double least_error;
};
const std::array<KnownPyramid, 8> kPyramids = {{{{std::sqrt(8.0), 2, 5e-2}, 4e-3},
                                                {{std::sqrt(8.0), 1.5, 5e-2}, 4e-3},
                                                {{std::sqrt(2.0), 2, 5e-2}, 4e-3},
                                                {{1.5, 2, 3e-2}, 4e-3},
                                                {{std::sqrt(2.0), 1.5, 3e-2}, 2e-3},
                                                {{std::sqrt(0.5), 1.5, 1e-2}, 1e-3},
                                                {{std::sqrt(0.5), 1, 1e-3}, 1e-4},
                                                {{std::sqrt(0.125), 0.75, 1e-4}, 0}}};
constexpr std::size_t kPrecisePyramid = 6;  // of these: precise enough to stand for exact triangles

/// Cells of the normals that the triangles of a texel cover, about: a pyramid is built piece by piece.
double pieces_a_texel(const Surface& surface, double cell) {
  constexpr int samples = 64;  // a side
  double sum = 0;
  for (int n = 0; n < samples * samples; ++n) {
    const int i = (n % samples) * surface.width() / samples, j = (n / samples) * surface.height() / samples;
    const Eigen::Vector2d& normal = surface.texel(i, j);
    sum += (1 + (surface.texel(i + 1, j) - normal).norm() / cell) *
           (1 + (surface.texel(i, j + 1) - normal).norm() / cell);
  }
  return sum / (samples * samples);
}

}  // namespace

std::unique_ptr<Evaluator> Candidate::make(Device& device, const Surface& surface,
                                           const std::shared_ptr<PyramidStore>& store,
                                           const TriangleEvaluator* triangles) const {
  if (kind == CandidateKind::triangles) {
    TriangleSettings settings;
    settings.tolerance = tolerance;
    if (triangles != nullptr) return std::make_unique<TriangleEvaluator>(device, *triangles, settings);
    return std::make_unique<TriangleEvaluator>(device, surface, settings);
  }
  if (kind == CandidateKind::gaussians) {
    MixtureSettings settings;
    settings.elements = elements;
    return std::make_unique<GaussianEvaluator>(device, surface, settings);
  }
  PyramidSettings settings;
  settings.precision = precision;
  settings.store = store;
  return std::make_unique<PyramidEvaluator>(device, surface, settings);
}

CostModel Candidate::cost_model(const Surface& surface, bool first_order) const {
  if (kind == CandidateKind::triangles) return triangles_cost(surface.interpolation(), first_order);
  return kind == CandidateKind::gaussians ? gaussians_cost(elements, first_order) : pyramid_cost(first_order);
}

double Candidate::build_cost(const Surface& surface, int roughness) const {
  const double pieces =
      kind == CandidateKind::pyramid ? pieces_a_texel(surface, cell_width(roughness, precision)) : 1;
  return cost_model(surface, false).texel * pieces * surface.width() * surface.height();
}

Candidates candidates_for(double tolerance, Interpolation interpolation) {
  Candidates result;
  const auto add = [&](Candidate candidate) { result.all.push_back(std::move(candidate)); };
  for (std::size_t n = 0; n < kPyramids.size(); ++n) {
    const auto& [precision, least_error] = kPyramids[n];
    if (n == kPrecisePyramid) result.precise_pyramid = result.all.size();
    if (tolerance > least_error)
      add({CandidateKind::pyramid,
           fmt::format("pyramid, blocks of {:.2g} footprints, cells of {:.2g} roughnesses",
                       precision.block_ratio, precision.cell_ratio),
           0, precision});
  }
  if (interpolation != Interpolation::bicubic)
    for (const int elements : {1, 2, 4})
      add({CandidateKind::gaussians, fmt::format("gaussians, {} a texel and axis", elements), elements});
  result.triangles = result.all.size();
  add({CandidateKind::triangles, fmt::format("triangles, to {:.2g}", tolerance), 0, {}, tolerance});
  result.exact_triangles = result.all.size();
  add({CandidateKind::triangles, "triangles", 0, {}, kExactTriangles});
  return result;
}

}  // namespace mica::host
