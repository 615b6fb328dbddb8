// `mica eval --quantity brdf`, `energy` and `sample`: shapes, what they have in common, and rows that are no
// questions.
#include <algorithm>
#include <cmath>

#include "tests/app/command.h"

namespace mica::host::app::eval_patch_test {
namespace {

const std::string kPatch = "eval --map map.exr --ndf beckmanns --roughness 0.05 -o answers.npy --queries ";

class EvalPatch : public CommandTest {
 protected:
  EvalPatch() { write_map(); }

  /// Values of answers.npy, which has this shape.
  std::vector<float> answers(const std::string& arguments, const std::string& shape) {
    const Outcome outcome = mica(kPatch + arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const std::string file = bytes(path("answers.npy"));
    EXPECT_NE(file.find("'shape': " + shape), std::string::npos) << file.substr(0, 128);
    const std::size_t begin = file.find('\n') + 1;
    std::vector<float> values((file.size() - begin) / sizeof(float));
    std::memcpy(values.data(), file.data() + begin, values.size() * sizeof(float));
    return values;
  }
};

/// u v cuu cuv cvv ox oy oz; footprints of a texel or two on a map of 32 x 32.
Rows view_rows(int count) {
  Rows rows;
  for (int n = 0; n < count; ++n)
    rows.push_back({0.1 * n, 0.3, 2.0 / 1024, 0.0, 1.0 / 1024, 0.3 * std::sin(n), 0.3 * std::cos(n), 1.0});
  return rows;
}
Rows brdf_rows(int count) {
  Rows rows = view_rows(count);
  for (std::size_t n = 0; n < rows.size(); ++n)
    rows[n].insert(rows[n].end(), {-0.3 * std::sin(n), -0.2 * std::cos(n), 0.9});
  return rows;
}

TEST_F(EvalPatch, BrdfIsOneNumberARowAndTakesDirectionsOfAnyLength) {
  Rows rows = brdf_rows(12);
  write("q.npy", npy_of(rows));
  const std::vector<float> values = answers("q.npy --quantity brdf", "(12,)");
  ASSERT_EQ(values.size(), 12u);
  for (const float value : values) EXPECT_TRUE(std::isfinite(value) && value >= 0);
  EXPECT_GT(*std::max_element(values.begin(), values.end()), 0.1f);
  for (std::vector<double>& row : rows)
    for (std::size_t k = 5; k < 8; ++k) row[k] *= 1024;
  write("long.npy", npy_of(rows));
  EXPECT_EQ(answers("long.npy --quantity brdf", "(12,)"), values);
  // Light bounces once, and Eq. 7 is symmetric but for the cosine.
  EXPECT_EQ(answers("q.npy --quantity brdf --part single", "(12,)"), values);
  EXPECT_EQ(answers("q.npy --quantity brdf --part multiple", "(12,)"), std::vector<float>(12, 0.0f));
  EXPECT_NE(answers("q.npy --quantity brdf --masking geometric", "(12,)"), values);
}

TEST_F(EvalPatch, EnergyIsScatteredOrLost) {
  write("q.npy", npy_of(view_rows(5)));
  const std::vector<float> values = answers("q.npy --quantity energy", "(5, 2)");
  ASSERT_EQ(values.size(), 10u);
  for (std::size_t n = 0; n < 10; n += 2) {
    EXPECT_LE(values[n], 1.001f);
    EXPECT_NEAR(values[n] + values[n + 1], 1, 1e-6);
  }
}

TEST_F(EvalPatch, SamplesHaveTheWeightOfTheirBrdfAndDependOnTheSeed) {
  const Rows views = view_rows(40);
  write("q.npy", npy_of(views));
  const std::vector<float> samples = answers("q.npy --quantity sample --seed 5", "(40, 5)");
  ASSERT_EQ(samples.size(), 200u);
  EXPECT_EQ(answers("q.npy --quantity sample --seed 5", "(40, 5)"), samples);
  EXPECT_NE(answers("q.npy --quantity sample --seed 6", "(40, 5)"), samples);
  Rows rows = views;
  for (std::size_t n = 0; n < rows.size(); ++n)
    for (std::size_t k = 0; k < 3; ++k) rows[n].push_back(samples[5 * n + k]);
  write("b.npy", npy_of(rows));
  const std::vector<float> brdf = answers("b.npy --quantity brdf", "(40,)");
  for (std::size_t n = 0; n < rows.size(); ++n)
    EXPECT_NEAR(samples[5 * n + 3] * samples[5 * n + 4], brdf[n], 1e-3 * brdf[n]) << "row " << n;
}

TEST_F(EvalPatch, DirectionsBelowTheHorizonSeeNothing) {
  Rows rows = brdf_rows(2);
  rows[0][7] = -1, rows[1][10] = -0.5;
  write("q.npy", npy_of(rows));
  EXPECT_EQ(answers("q.npy --quantity brdf", "(2,)"), std::vector<float>(2, 0.0f));
}

TEST_F(EvalPatch, RowsThatAreNoQuestionsAreNamedAndNothingIsWritten) {
  Rows rows = brdf_rows(5);
  rows[1][5] = rows[1][6] = rows[1][7] = 0;
  rows[2][9] = NAN;
  rows[3][3] = 1;
  write("q.npy", npy_of(rows));
  const Outcome outcome = mica(kPatch + "q.npy --quantity brdf");
  EXPECT_EQ(outcome.code, 2);
  for (const char* const part :
       {"3 of 5 rows", "row 1: direction o has length 0", "row 2: direction i is not finite",
        "row 3: covariance is not positive definite"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(path("answers.npy")));
  EXPECT_EQ(
      mica("eval --map map.exr --ndf triangles --roughness 0.05 -o a.npy --quantity brdf --queries q.npy")
          .code,
      2);
}

}  // namespace
}  // namespace mica::host::app::eval_patch_test
