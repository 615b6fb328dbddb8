// `mica eval --ndf cavities`: its quantities, its options, and what it has no answer for.
#include <cmath>
#include <cstring>

#include "tests/app/command.h"

namespace mica::host::app::eval_cavities_test {
namespace {

class EvalCavities : public CommandTest {
 protected:
  EvalCavities() {
    write_map();
    Rows views, pairs;
    for (int n = 0; n < 8; ++n) {
      views.push_back({0.1 * n, 0.3, 2.0 / 1024, 0.0, 1.0 / 1024, 0.3 * std::sin(n), 0.3 * std::cos(n), 1.0});
      pairs.push_back(views.back());
      pairs.back().insert(pairs.back().end(), {-0.3 * std::sin(n), -0.2 * std::cos(n), 0.9});
    }
    write("views.npy", npy_of(views));
    write("pairs.npy", npy_of(pairs));
  }

  std::vector<float> answers(const std::string& arguments) {
    const Outcome outcome =
        mica("eval --map map.exr --ndf cavities --roughness 0.05 -o answers.npy --queries " + arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const std::string file = bytes(path("answers.npy"));
    const std::size_t begin = file.find('\n') + 1;
    std::vector<float> values((file.size() - begin) / sizeof(float));
    std::memcpy(values.data(), file.data() + begin, values.size() * sizeof(float));
    return values;
  }
};

TEST_F(EvalCavities, PartsAddUp) {
  for (const std::string options : {"", " --energy sampled", " --compensation specular", " --elements 2"}) {
    const std::vector<float> all = answers("pairs.npy --quantity brdf" + options),
                             single = answers("pairs.npy --quantity brdf --part single" + options),
                             multiple = answers("pairs.npy --quantity brdf --part multiple" + options);
    ASSERT_EQ(all.size(), 8u);
    for (std::size_t n = 0; n < all.size(); ++n) {
      EXPECT_GT(all[n], 0) << options;
      EXPECT_FLOAT_EQ(single[n] + multiple[n], all[n]) << options;
    }
  }
}

TEST_F(EvalCavities, EnergyIsWholeAndWeightsAreOne) {
  for (const std::string options : {"", " --energy sampled"}) {
    const std::vector<float> energy = answers("views.npy --quantity energy" + options);
    ASSERT_EQ(energy.size(), 16u);
    for (std::size_t n = 0; n < energy.size(); n += 2) EXPECT_FLOAT_EQ(energy[n] + energy[n + 1], 1);
    const std::vector<float> samples = answers("views.npy --quantity sample --seed 3" + options);
    ASSERT_EQ(samples.size(), 40u);
    for (std::size_t n = 0; n < samples.size(); n += 5) {
      const float* row = samples.data() + n;
      EXPECT_NEAR(row[0] * row[0] + row[1] * row[1] + row[2] * row[2], 1, 1e-5);
      EXPECT_GT(row[3], 0);
      EXPECT_NEAR(row[4], 1, 1e-6);
    }
  }
}

TEST_F(EvalCavities, HasNoDensityOfNormals) {
  const Outcome outcome =
      mica("eval --map map.exr --ndf cavities --roughness 0.05 -o a.npy --queries views.npy");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("--quantity brdf"), std::string::npos) << outcome.err;
}

TEST_F(EvalCavities, RefusesWhatItDoesNotTake) {
  const std::string call =
      "eval --map map.exr --ndf cavities --roughness 0.05 -o a.npy --queries views.npy --quantity ";
  EXPECT_EQ(mica(call + "energy --elements 3").code, 2);
  EXPECT_EQ(mica(call + "energy --energy guess").code, 2);
  EXPECT_EQ(mica(call + "energy --compensation none").code, 2);
}

}  // namespace
}  // namespace mica::host::app::eval_cavities_test
