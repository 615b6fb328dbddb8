// Pictures and tables in parts: the same bytes, and no wrong part unnoticed.
#include "tests/app/farm_job.h"

namespace mica::host::app::shards_test {
namespace {

constexpr int kUsage = 2, kFile = 4;

class Shards : public FarmTest {
 protected:
  void expect_refused(const std::string& parts, const std::string& output, int code,
                      const std::string& message) {
    const Outcome outcome = mica("join " + parts + " -o " + output);
    EXPECT_EQ(outcome.code, code) << parts << outcome.err;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(path(output)));
  }
};

TEST_F(Shards, OfAPictureAreThePicture) {
  const std::string render = "render job.toml --quiet --frames ";
  ASSERT_EQ(mica(render + "2 -o whole.exr").code, 0);
  for (const char* shard : {"1/4", "2/4", "3/4", "4/4"})
    ASSERT_EQ(mica(render + "2 -o p.exr --shard " + shard).code, 0);
  ASSERT_EQ(mica("join p.0002.part-*-of-4.exr -o joined.exr").code, 0);
  EXPECT_TRUE(bytes(path("joined.exr")) == bytes(path("whole.0002.exr")));
  EXPECT_TRUE(bytes(path("joined.png")) == bytes(path("whole.0002.png")));
  ASSERT_EQ(mica(render + "2 -o p.exr --rows 2-8").code, 0);
  ASSERT_EQ(mica("join p.0002.rows-00002-00008.exr p.0002.part-1-of-4.exr -o rows.exr").code, 0);
  EXPECT_TRUE(bytes(path("rows.exr")) == bytes(path("joined.exr")));

  const auto part = [](int n) { return "p.0002.part-" + std::to_string(n) + "-of-4.exr "; };
  expect_refused(part(1) + part(3) + part(4), "x.exr", kUsage, "rows 2-3 are in no part");
  expect_refused(part(1) + part(2) + part(3), "x.exr", kUsage, "rows 6-8 are in no part");
  expect_refused(part(1) + part(2) + part(3) + part(4) + part(3), "x.exr", kUsage,
                 "p.0002.part-3-of-4.exr: rows 4-5 are in p.0002.part-3-of-4.exr as well");
  expect_refused(part(1) + part(2) + part(3) + part(4) + "whole.0002.exr", "x.exr", kUsage,
                 "whole.0002.exr: is no part of a picture");
  ASSERT_EQ(mica(render + "3 -o p.exr --shard 2/4").code, 0);
  expect_refused(part(1) + "p.0003.part-2-of-4.exr " + part(3) + part(4), "x.exr", kUsage,
                 "p.0003.part-2-of-4.exr: is a part of another picture: mica:frame is 3 instead of 2");
  const std::string third = bytes(path("p.0002.part-3-of-4.exr"));
  write("p.0002.part-3-of-4.exr", third.substr(0, third.size() - 20));
  expect_refused(part(1) + part(2) + part(3) + part(4), "x.exr", kFile, "p.0002.part-3-of-4.exr: ");
  write("p.0002.part-3-of-4.exr", third);
  change("p.0002.part-3-of-4.exr", third.size() - 10);
  expect_refused(part(1) + part(2) + part(3) + part(4), "x.exr", kFile, "p.0002.part-3-of-4.exr: ");
}

TEST_F(Shards, AreRefusedWhereThereIsNothingToShare) {
  for (const char* shard : {"0/4", "5/4", "1", "1/0", "x/2", "1/2/3", "1/10"})
    EXPECT_EQ(mica(std::string("render job.toml --quiet --shard ") + shard).code, kUsage) << shard;
  for (const char* rows : {"9", "3-2", "1-9", "x", "-1"})
    EXPECT_EQ(mica(std::string("render job.toml --quiet --rows=") + rows).code, kUsage) << rows;
  EXPECT_EQ(mica("render job.toml --shard 1/2 --rows 1-2").code, kUsage);
  EXPECT_EQ(mica("render job.toml -o a.png --shard 1/2").code, kUsage);
}

// `auto` looks at all queries, `sample` draws by the row's number, and arrays may be stored by columns.
TEST_F(Shards, OfATableAreTheTable) {
  write("q.npy", npy_of(query_rows(40)));
  const std::string eval = "eval --map map.exr --encoding signed --roughness 0.1 --queries q.npy ";
  ASSERT_EQ(mica(eval + "--ndf auto -o whole.npy").code, 0);
  for (const char* shard : {"1/3", "2/3", "3/3"})
    ASSERT_EQ(mica(eval + "--ndf auto -o d.npy --shard " + shard).code, 0);
  ASSERT_EQ(mica("join d.npy.part-3-of-3 d.npy.part-1-of-3 d.npy.part-2-of-3 -o joined.npy").code, 0);
  EXPECT_TRUE(bytes(path("joined.npy")) == bytes(path("whole.npy")));

  expect_refused("d.npy.part-1-of-3 d.npy.part-3-of-3", "x.npy", kUsage, "rows 13-25 are in no part");
  expect_refused("d.npy.part-*-of-3 d.npy.part-1-of-3", "x.npy", kUsage,
                 "d.npy.part-1-of-3: rows 0-12 are in d.npy.part-1-of-3 as well");
  expect_refused("whole.npy", "x.npy", kFile, "whole.npy: is no part of a table");
  ASSERT_EQ(mica(eval + "--ndf smooth -o other.npy --shard 2/3").code, 0);
  expect_refused("d.npy.part-1-of-3 other.npy.part-2-of-3 d.npy.part-3-of-3", "x.npy", kUsage,
                 "other.npy.part-2-of-3: is a part of another table: method is smooth instead of auto");
  const std::string second = bytes(path("d.npy.part-2-of-3"));
  write("d.npy.part-2-of-3", second.substr(0, second.size() - 1));
  expect_refused("d.npy.part-*", "x.npy", kFile, "d.npy.part-2-of-3: is cut short");
  write("d.npy.part-2-of-3", second);
  change("d.npy.part-2-of-3", second.size() - 40);
  expect_refused("d.npy.part-*", "x.npy", kFile, "d.npy.part-2-of-3: is damaged");
}

TEST_F(Shards, OfDrawsAreTheDraws) {
  Rows views;
  for (const std::vector<double>& row : query_rows(10))
    views.push_back({row[0], row[1], row[2], row[3], row[4], 0.3 * row[5], 0.3 * row[6], 1});
  write("v.npy", npy_of(views));
  const std::string eval =
      "eval --map map.exr --encoding signed --ndf beckmanns --roughness 0.1 --queries v.npy --quantity "
      "sample ";
  ASSERT_EQ(mica(eval + "-o whole.npy").code, 0);
  for (const char* shard : {"1/2", "2/2"}) ASSERT_EQ(mica(eval + "-o d.npy --shard " + shard).code, 0);
  ASSERT_EQ(mica("join d.npy.part-*-of-2 -o joined.npy").code, 0);
  EXPECT_TRUE(bytes(path("joined.npy")) == bytes(path("whole.npy")));
}

// A bad row is named by its number in the whole table, by the shard that has it.
TEST_F(Shards, NameRowsOfTheWholeTable) {
  Rows rows = query_rows(10);
  rows[7][2] = -1;
  write("q.npy", npy_of(rows));
  const std::string eval =
      "eval --map map.exr --encoding signed --ndf smooth --roughness 0.1 --queries q.npy ";
  EXPECT_EQ(mica(eval + "-o d.npy --shard 1/2").code, 0);
  const Outcome outcome = mica(eval + "-o d.npy --shard 2/2");
  EXPECT_EQ(outcome.code, kUsage);
  EXPECT_NE(outcome.err.find("row 7: "), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(path("d.npy.part-2-of-2")));
}

}  // namespace
}  // namespace mica::host::app::shards_test
