#include "host/base/words.h"

#include <gtest/gtest.h>

#include <set>

#include "host/base/cavities.h"
#include "host/base/glints_description.h"
#include "host/base/masking.h"
#include "host/image/image.h"
#include "host/surface/description.h"

namespace mica::host::words_test {
namespace {

template <typename Enum>
void expect_one_word_a_value(std::size_t values) {
  std::set<Enum> found;
  for (const std::string& word : list_words<Enum>()) {
    ASSERT_TRUE(parse_word<Enum>(word)) << word;
    found.insert(*parse_word<Enum>(word));
    EXPECT_EQ(word_of(*parse_word<Enum>(word)), word);
  }
  EXPECT_EQ(found.size(), values);
}

TEST(Words, GiveEachValueOneWord) {
  expect_one_word_a_value<Compensation>(2);
  expect_one_word_a_value<LostEnergy>(2);
  expect_one_word_a_value<Masking>(3);
  expect_one_word_a_value<EnergyBound>(2);
  expect_one_word_a_value<Distribution>(2);
  expect_one_word_a_value<GlintsDescription::Mapping>(2);
  expect_one_word_a_value<GlintsDescription::Masking>(2);
  expect_one_word_a_value<Interpolation>(3);
  expect_one_word_a_value<Encoding>(4);
  expect_one_word_a_value<GreenDirection>(2);
  expect_one_word_a_value<TexelRepair>(2);
  expect_one_word_a_value<ScratchProfile>(2);
  expect_one_word_a_value<ToneMap>(4);
}

TEST(Words, ThatWereOthersAreUnderstood) {
  EXPECT_EQ(parse_word<LostEnergy>("table"), LostEnergy::sampled);
  const std::vector<std::string> listed = list_words<LostEnergy>();
  EXPECT_EQ(listed, std::vector<std::string>({"exact", "sampled"}));
}

TEST(Words, AreThoseOfTheCommandLine) {
  EXPECT_EQ(word_of(Encoding::signed_float), "signed");
  EXPECT_EQ(parse_word<Distribution>("ggx"), Distribution::trowbridge_reitz);
  EXPECT_EQ(parse_word<Interpolation>("Bicubic"), std::nullopt);
  EXPECT_EQ(parse_word<Interpolation>(""), std::nullopt);
}

}  // namespace
}  // namespace mica::host::words_test
