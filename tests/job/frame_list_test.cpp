// Lists of frames, read and written.
#include "host/job/frame_list.h"

#include <gtest/gtest.h>

namespace mica::host::frame_list_test {
namespace {

TEST(FrameList, ReadsRunsAndWritesThemShort) {
  FrameSettings frames;
  frames.first = 0, frames.last = 40, frames.given = true;
  const auto read = [&](const std::string& text) { return parse_frames(text, frames, text); };
  EXPECT_EQ(read("3"), std::vector<int>({3}));
  EXPECT_EQ(read("1-9x3,2,8-10"), std::vector<int>({1, 2, 4, 7, 8, 9, 10}));
  EXPECT_EQ(read("0-5x2147483647"), std::vector<int>({0}));
  EXPECT_EQ(read("5-5x2147483647"), std::vector<int>({5}));
  for (const char* wrong : {"", "1-9x0", "1x2", "1-9x", ",", "1,", "1,,2", "1-9x-1", "1 - 9", "3,50"})
    EXPECT_THROW(read(wrong), UsageError) << wrong;
  for (const char* text : {"3", "1-5", "1-9x2", "1,5", "1-3,5,9-12", "0-40x10", "2-3", "1,4-6,10-40x10"})
    EXPECT_EQ(frame_list(read(text)), text);
  EXPECT_EQ(frame_list({}), "");
}

}  // namespace
}  // namespace mica::host::frame_list_test
