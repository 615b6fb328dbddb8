#include <gtest/gtest.h>
#include "host/methods/smooth/smooth_evaluator.h"
#include "tests/methods/first_order_queries.h"
using namespace mica::host;
TEST(X, Y) {
  Device d(0);
  for (auto wh : {std::pair(96, 70), std::pair(64, 64)}) {
    const Eigen::Vector2d normal(0.1, -0.05);
    const Surface surface(wh.first, wh.second, Interpolation::bilinear,
                          std::vector<Eigen::Vector2d>(wh.first * wh.second, normal));
    SmoothEvaluator e(d, surface);
    for (double s : {0.6, 2.0, 3.0, 5.0, 10.0}) {
      Query q;
      q.footprint = make_footprint(surface, {.3, .8}, s, .5 * s, 1.1);
      q.roughness = .01;
      q.half_vector = normal;
      std::printf("%d sigma %g plain %g\n", wh.first, s, e.evaluate({q})[0] * 2 * kPi * 1e-4);
      Query t = q;
      t.half_vector_turn(0, 0) = 1e-9;
      std::printf("   turned %g\n", e.evaluate({t})[0] * 2 * kPi * 1e-4);
    }
  }
}
