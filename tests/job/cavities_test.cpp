// The keys of `ndf = "cavities"`, and what they refuse.
#include "tests/job/job_text.h"

namespace mica::host::cavities_test {
namespace {

using test::JobFolder;
using test::kLeastJob;
using test::replaced;

std::string with(const std::string& keys) {
  return replaced(kLeastJob, "surface = \"bumps\"\n",
                  "surface = \"bumps\"\nndf = \"cavities\"\n" + keys + "\n");
}

TEST(CavitiesInAJob, HaveTheirKeys) {
  const JobFolder folder;
  const MaterialDescription plain = folder.load(with("")).scene.materials[0];
  EXPECT_EQ(plain.ndf, "cavities");
  EXPECT_EQ(describe(*plain.settings),
            "compensation diffuse, compensation-width 2, energy exact, elements 1");
  const MaterialDescription other =
      folder
          .load(with(
              "compensation = \"specular\"\ncompensation_width = 5\nenergy = \"sampled\"\nspacing = 0.5"))
          .scene.materials[0];
  EXPECT_EQ(describe(*other.settings),
            "compensation specular, compensation-width 5, energy sampled, elements 2");
}

TEST(CavitiesInAJob, RefuseWhatTheyDoNotTake) {
  const JobFolder folder;
  for (const std::string keys :
       {"spacing = 0.7", "energy = \"guess\"", "compensation = \"none\"", "elements = 2",
        "masking = \"exact\"", "compensation_width = 0", "multiple_scattering = \"kept\""}) {
    const std::vector<JobIssue> issues = folder.issues(with(keys));
    ASSERT_EQ(issues.size(), 1u) << keys;
    EXPECT_EQ(issues[0].line, 8) << keys;
  }
  EXPECT_EQ(folder.issues(replaced(kLeastJob, "surface = \"bumps\"\n", "surface = \"bumps\"\nspacing = 1\n"))
                .size(),
            1u);
}

}  // namespace
}  // namespace mica::host::cavities_test
