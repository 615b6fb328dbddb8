#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host/image/image.h"

namespace mica::host::tone_map_test {
namespace {

TEST(ToneMap, AreTheirCurves) {
  EXPECT_EQ(tone_mapped(ToneMap::clamp, 0.7), 0.7);
  EXPECT_EQ(tone_mapped(ToneMap::clamp, 7), 1);
  EXPECT_EQ(tone_mapped(ToneMap::shoulder, 0.8), 0.8);
  EXPECT_NEAR(tone_mapped(ToneMap::shoulder, 1), 1 - 0.2 * std::exp(-1), 1e-12);
  EXPECT_NEAR(tone_mapped(ToneMap::reinhard, 3), 0.75, 1e-12);
  // 0.18 of middle grey and 1: (0.081324 + 0.0054) / (0.078732 + 0.1062 + 0.14), 2.54 / 3.16.
  EXPECT_NEAR(tone_mapped(ToneMap::filmic, 0.18), 0.0867240 / 0.3249320, 1e-6);
  EXPECT_NEAR(tone_mapped(ToneMap::filmic, 1), 2.54 / 3.16, 1e-12);
}

TEST(ToneMap, NeverFallAndStayInRange) {
  for (const ToneMap map : {ToneMap::clamp, ToneMap::shoulder, ToneMap::reinhard, ToneMap::filmic}) {
    double before = 0;
    EXPECT_EQ(tone_mapped(map, 0), 0);
    for (double x = 1e-6; x < 1e12; x *= 1.5) {
      const double shown = tone_mapped(map, x);
      EXPECT_GE(shown, before) << x;
      EXPECT_LE(shown, 1) << x;
      before = shown;
    }
    EXPECT_EQ(tone_mapped(map, std::numeric_limits<double>::infinity()), 1);
  }
}

}  // namespace
}  // namespace mica::host::tone_map_test
