#include "host/base/error_norms.h"

#include <gtest/gtest.h>

#include <vector>

namespace mica::host::error_norms_test {
namespace {

TEST(RelativeL2, IsTheNormOfErrorsOverThatOfReferences) {
  const std::vector<float> values = {1.5f, 2, 1};
  const std::vector<double> references = {1, 2, 2};
  EXPECT_DOUBLE_EQ(relative_l2(values, references), std::sqrt(1.25 / 9));
}

TEST(RelativeL2, HasAnAnswerWhereReferencesAreZero) {
  RelativeL2 error;
  error.add(0.0f, 0.0);
  EXPECT_FALSE(error.has_reference());
  EXPECT_EQ(error.value(), 0);
  error.add(1.0f, 0.0);
  EXPECT_TRUE(std::isinf(error.value()));
  error.add(2.0f, 2.0);
  EXPECT_TRUE(error.has_reference());
  EXPECT_EQ(error.value(), 0.5);
}

TEST(RelativeL2, DoesNotHideWhatIsNoNumber) {
  RelativeL2 error;
  error.add(std::nan(""), 1.0);
  EXPECT_TRUE(std::isnan(error.value()));
}

}  // namespace
}  // namespace mica::host::error_norms_test
