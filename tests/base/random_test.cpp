#include "host/base/random.h"

#include <gtest/gtest.h>

namespace mica::host::random_test {
namespace {

// The first outputs of SplitMix64 from the state 0, as its authors' program prints them.
TEST(Random, MixesLikeSplitMix64) {
  EXPECT_EQ(mix_bits(0), 0xe220a8397b1dcdafu);
  EXPECT_EQ(mix_bits(kGoldenBits), 0x6e789e6aa1b965f4u);
  EXPECT_EQ(mix_bits(2 * kGoldenBits), 0x06c45d188009454fu);
}

}  // namespace
}  // namespace mica::host::random_test
