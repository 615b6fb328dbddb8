// `gaussians` on queries whose half vector turns over the footprint and whose lobe is not round.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <memory>

#include "host/methods/gaussians/mixture_evaluator.h"
#include "tests/methods/first_order_queries.h"

namespace mica::host::first_order_gaussians_test {
namespace {

Device& device() {
  static Device shared(0);
  return shared;
}

/// What the sum of the elements' position kernels varies by over a map: 2 exp(-2 pi^2 k) an axis. Without a
/// turn each footprint is divided by its own sum; with one, half vectors pick places of which each has
/// another.
constexpr double kRipple = 0.057;

/// The method's own error may grow by a fifth where the half vector turns, and the ripple comes in.
TEST(GaussiansFirstOrder, IsHardlyLessPreciseThanWithout) {
  for (const FirstOrderSurface& kind : first_order_surfaces()) {
    if (kind.name != "spectrum_bilinear" && kind.name != "flakes_nearest" && kind.name != "rim_of_odd_size")
      continue;
    const Surface surface = kind.make();
    GaussianEvaluator evaluator(device(), surface);
    const reference::Oracle oracle(surface, 1e-5);
    for (const double lobe : {0.005, 0.02, 0.08}) {
      const double plain =
          relative_l2(&evaluator, references_of(oracle), without_first_order(surface, lobe, 10, 40, 12));
      const double turned =
          relative_l2(&evaluator, references_of(oracle), first_order_probes(surface, lobe, 10, 40, 12));
      std::printf("%-18s lobe %5.3f: relative L2 %.4f with a turn, %.4f without\n", kind.name.c_str(), lobe,
                  turned, plain);
      EXPECT_LE(turned, std::hypot(1.2 * plain, kRipple)) << kind.name << ", lobe " << lobe;
    }
  }
}

TEST(GaussiansFirstOrder, OfAFlatMapIsTheLobeWidenedByTheTurn) {
  expect_widened_lobes(
      [](const Surface& surface) { return std::make_unique<GaussianEvaluator>(device(), surface); },
      [](double sigma) { return sigma < 1 ? 2 * kRipple : 3e-3; });
}

}  // namespace
}  // namespace mica::host::first_order_gaussians_test
