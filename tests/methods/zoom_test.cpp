// A zoom must not show where `pyramid` changes its level.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/base/error_norms.h"
#include "host/base/random.h"
#include "host/methods/pyramid/pyramid_evaluator.h"
#include "host/surface/texel_footprint.h"
#include "tests/methods/bilinear_samples.h"

namespace mica::host::zoom_test {
namespace {

Device& device() {
  static Device shared(0);  // programs are built once for all tests
  return shared;
}

/// Relative L2 from each frame of a zoom to the next, and whether the level changed.
struct Change {
  double amount;
  bool of_level;
};

std::vector<Change> zoom(const Surface& surface, double first_sigma, double last_sigma, int frames) {
  constexpr int half_vectors = 150;
  PyramidEvaluator pyramid(device(), surface);
  std::vector<Query> queries(half_vectors);
  for (int n = 0; n < half_vectors; ++n) {
    const auto random = [n](std::uint64_t stream) { return random_unit(3, stream, n); };
    queries[n].half_vector = surface.texel(std::lround(256 * random(0)), std::lround(256 * random(1)));
    queries[n].roughness = 0.02;
  }
  std::vector<Change> changes;
  std::vector<float> last;
  std::optional<PyramidChoice> last_choice;
  for (int frame = 0; frame < frames; ++frame) {
    const double sigma = first_sigma * std::pow(last_sigma / first_sigma, frame / (frames - 1.0));
    for (Query& query : queries) query.footprint = make_footprint(surface, {0.37, 0.61}, sigma, sigma, 0);
    const std::vector<float> densities = pyramid.evaluate(queries);
    const std::optional<PyramidChoice> choice = pyramid.choose(queries.front());
    const bool same = choice.has_value() == last_choice.has_value() &&
                      (!choice || !(*choice < *last_choice || *last_choice < *choice));
    if (frame > 0)
      changes.push_back({relative_l2(densities, std::vector<double>(last.begin(), last.end())), !same});
    last = densities;
    last_choice = choice;
  }
  return changes;
}

/// From the texels through three levels to the uniform footprint; a frame's footprint is 3% wider than the
/// one before. Without a blend of the levels one frame changes by 1.0% between frames that change by 0.2%.
TEST(Zoom, DoesNotShowWhereTheLevelChanges) {
  const Surface surface =
      make_surface({"test", SpectrumSurface{256, 0.15, 8, 3}, Interpolation::bilinear}, nullptr);
  const std::vector<Change> changes = zoom(surface, 8, 300, 120);
  int level_changes = 0;
  for (std::size_t n = 1; n + 1 < changes.size(); ++n) {
    level_changes += changes[n].of_level ? 1 : 0;
    const double beside = std::max(changes[n - 1].amount, changes[n + 1].amount);
    if (changes[n].of_level)
      std::printf("level change: %.2f%%, beside it %.2f%%\n", 100 * changes[n].amount, 100 * beside);
    EXPECT_LE(changes[n].amount, 1.5 * beside) << "frame " << n + 1;
  }
  EXPECT_GE(level_changes, 4);
}

}  // namespace
}  // namespace mica::host::zoom_test
