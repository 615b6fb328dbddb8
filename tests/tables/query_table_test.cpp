// Query tables: what is read from a file, and what is refused.
#include "host/tables/query_table.h"

#include <cmath>
#include <limits>

#include "host/methods/map/map_query.h"
#include "tests/app/command.h"

namespace mica::host::app::query_table_test {
namespace {

class QueryTables : public FolderTest {
 protected:
  /// The message of the error that reading `content` from `file` throws, led by its kind.
  std::string refusal(const std::string& file, const std::string& content) const {
    std::ofstream(path(file), std::ios::binary) << content;
    try {
      const QueryTable table(path(file), 0.01);
      table.check([](const Query& query) { return query_problem(query, 32, 32); });
    } catch (const UsageError& error) {
      return std::string("usage: ") + error.what();
    } catch (const FileError& error) {
      return std::string("file: ") + error.what();
    }
    return "accepted";
  }
  void expect_refusal(const std::string& file, const std::string& content, const std::string& kind,
                      const std::string& message) const {
    const std::string found = refusal(file, content);
    EXPECT_EQ(found.rfind(kind + ": " + path(file), 0), 0u) << found;
    EXPECT_NE(found.find(message), std::string::npos) << found;
  }
  static Rows rows(int count) { return query_rows(count); }
  static Rows rows_with(const std::vector<std::size_t>& bad, std::size_t column, double value) {
    Rows result = rows(20);
    for (const std::size_t row : bad) result[row][column] = value;
    return result;
  }
};

/// As NumPy and R read them.
TEST_F(QueryTables, TakeNumbersTooSmallForADoubleAsZero) {
  const std::string header = "u,v,cuu,cuv,cvv,s,t\n";
  std::ofstream(path("small.csv")) << header + "1e-400,-1e-999,1e-3,4.9e-324,1e-3,0,0\n";
  const QueryTable table(path("small.csv"), 0.01);
  const Query query = table.query(0);
  EXPECT_EQ(query.footprint.mean_uv, Eigen::Vector2d::Zero());
  EXPECT_EQ(query.footprint.cov_uv(0, 1), std::numeric_limits<double>::denorm_min());
  expect_refusal("large.csv", header + "1e400,0,1e-3,0,1e-3,0,0\n", "usage", "\"1e400\" is not a number");
}

TEST_F(QueryTables, RefuseDamagedArrays) {
  const std::string good = npy_of(rows(20)), data(20 * 7 * 8, '\0');
  const auto expect_damage = [&](const std::string& content, const std::string& message) {
    expect_refusal("damaged.npy", content, "file", message);
  };
  expect_damage("", "ends within");
  expect_damage("not numpy" + good, "not a .npy file");
  expect_damage(npy_bytes("<f8", false, "(20, 7)", data, 9), "version 9");
  expect_damage(npy_bytes("<f8", false, "(20, 7)", data, 0), "version 0");
  expect_damage(good.substr(0, 40), "ends within its header");
  expect_damage(good.substr(0, good.size() - 8), "promises 20 x 7 values of 8 bytes, but 1112");
  expect_damage(good + "12345678", "promises 20 x 7 values of 8 bytes, but 1128");
  expect_damage(npy_bytes("<f8", false, "(20, 7", data), "makes no sense");
  expect_damage(npy_bytes("<f8", false, "20", data), "makes no sense");
  expect_damage(npy_bytes("<f8", false, "(-20, 7)", data), "makes no sense");
  expect_damage(npy_bytes("<f8', 'colour': '", false, "(20, 7)", data), "unknown key \"colour\"");
  expect_damage(std::string("\x93NUMPY\x01\x00\x03\x00{}\n", 13), "lacks one of");
  expect_damage(std::string("\x93NUMPY\x02\x00\xff\xff\xff\xff{}\n", 15), "claims 4294967295 bytes");
}

/// Shapes that no file holds, also where the number of bytes overflows: nothing is allocated.
TEST_F(QueryTables, RefuseShapesBeyondTheFile) {
  const std::string data(20 * 7 * 8, '\0');
  for (const char* const shape : {"(1000000000000000000, 7)", "(2305843009213693952, 8)", "(0, 7)",
                                  "(7, 2635249153387078803)", "(18446744073709551615, 18446744073709551615)"})
    expect_refusal("huge.npy", npy_bytes("<f8", false, shape, data), "file", "its header promises");
  expect_refusal("endless.npy", npy_bytes("<f8", false, "(99999999999999999999999999, 7)", data), "file",
                 "too large");
}

TEST_F(QueryTables, RefuseOtherArrays) {
  const std::string data(20 * 7 * 8, '\0');
  expect_refusal("a.npy", npy_bytes("<f8", false, "(28, 5)", data), "usage",
                 "5 columns; expected one of\n  7: u v cuu cuv cvv s t\n  8: ");
  expect_refusal("a.npy", npy_bytes("<f8", false, "(140,)", data), "usage", "1 dimension");
  expect_refusal("a.npy", npy_bytes("<f8", false, "()", data.substr(0, 8)), "usage", "0 dimensions");
  expect_refusal("a.npy", npy_bytes("|O", false, "(20, 7)", data), "usage",
                 "\"|O\"; expected a float32 or float64");
  expect_refusal("a.npy", npy_bytes("<i8", false, "(20, 7)", data), "usage", "\"<i8\"");
  std::string records = npy_bytes("", false, "(20,)", data);
  records.replace(records.find("''"), 2, "[('u', '<f8')]");
  expect_refusal("a.npy", records, "usage", "holds records");
}

TEST_F(QueryTables, RefuseOtherText) {
  const std::string header = "u,v,cuu,cuv,cvv,s,t";
  expect_refusal("t.csv", "", "usage", "no header; expected u,v,cuu,cuv,cvv,s,t[,roughness]");
  expect_refusal("t.csv", "u,v,cuu,cuv,cvv,s\n", "usage", "t.csv:1: column t is missing");
  expect_refusal("t.csv", header + ",colour\n", "usage", "t.csv:1: the header names \"colour\"");
  expect_refusal("t.csv", "u," + header + "\n", "usage", "t.csv:1: column u appears twice");
  expect_refusal("t.csv", header + "\n0,0,1e-4\n", "usage", "t.csv:2: 3 values; the header names 7 columns");
  expect_refusal("t.csv", header + "\n\n0,0,1e-4,0,1e-4,zero,0\n", "usage",
                 "t.csv:3: column s: \"zero\" is not a number");
  expect_refusal("t.csv", header + "\n0,0,1e-4,0,1e-4,,0\n", "usage",
                 "t.csv:2: column s: \"\" is not a number");
  expect_refusal("t.csv", header + "\n0,0,1e-4,0,1e-4,0,0 0\n", "usage", "column t: \"0 0\"");
  expect_refusal("t.csv", header + "\n0,0,1e999,0,1e-4,0,0\n", "usage", "column cuu: \"1e999\"");
  expect_refusal("t.txt", header + "\n", "usage", "expected a .npy or .csv file");
}

TEST_F(QueryTables, NameTheRowsThatCannotBeEvaluated) {
  const auto expect_rows = [&](const Rows& table, const std::string& message) {
    expect_refusal("q.npy", npy_of(table), "usage", message);
  };
  EXPECT_EQ(refusal("q.npy", npy_of(rows(20))), "accepted");
  expect_rows(rows_with({3}, 5, std::nan("")),
              "1 of 20 rows cannot be evaluated (rows count from 0):\n  row 3: half vector");
  expect_rows(rows_with({4}, 0, std::numeric_limits<double>::infinity()), "row 4: uv is not finite");
  expect_rows(rows_with({1, 19}, 3, 1),
              "row 1: covariance is not positive definite\n  row 19: covariance is not");
  expect_rows(rows_with({0}, 2, 0), "row 0: covariance is not positive definite");
  expect_rows(rows_with({7}, 6, -1.5), "row 7: half vector");
  expect_rows(rows_with({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12}, 4, -1),
              "row 9: covariance is not positive definite\n  and 2 more");
  Rows rough = rows(3);
  for (std::vector<double>& row : rough) row.push_back(0.01);
  rough[2][7] = 0;
  expect_rows(rough, "1 of 3 rows cannot be evaluated (rows count from 0):\n  row 2: roughness 0");
}

TEST_F(QueryTables, NeedARoughness) {
  std::ofstream(path("q.npy"), std::ios::binary) << npy_of(rows(2));
  EXPECT_THROW(QueryTable(path("q.npy"), {}), UsageError);
}

TEST_F(QueryTables, HoldWhatTheFileSays) {
  std::ofstream(path("q.csv"))
      << "\xef\xbb\xbfu,v,cuu,cuv,cvv,s,t,roughness\r\n1,2,3e-1,-4e-2,5,.6,-0.7,0.08\r\n";
  const QueryTable table(path("q.csv"), 0.5);
  ASSERT_EQ(table.size(), 1u);
  const Query query = table.query(0);
  EXPECT_EQ(query.footprint.mean_uv, Eigen::Vector2d(1, 2));
  EXPECT_EQ(query.footprint.cov_uv(0, 0), 0.3);
  EXPECT_EQ(query.footprint.cov_uv(0, 1), -0.04);
  EXPECT_EQ(query.footprint.cov_uv(1, 0), -0.04);
  EXPECT_EQ(query.footprint.cov_uv(1, 1), 5);
  EXPECT_EQ(query.half_vector, Eigen::Vector2d(0.6, -0.7));
  EXPECT_EQ(query.roughness, 0.08);
}

/// NumPy, pandas and R, by their several ways of writing one row.
TEST_F(QueryTables, AreReadAsOthersWriteThem) {
  const std::string names = "u,v,cuu,cuv,cvv,s,t", row = "0.5,0.25,1e-3,0,1e-3,0.1,-0.05";
  const auto blanks = [](std::string text, char separator) {
    std::replace(text.begin(), text.end(), ',', separator);
    return text + "\n";
  };
  const std::vector<std::pair<std::string, std::string>> files = {
      {"plain.csv", names + "\n" + row + "\n"},
      {"PLAIN.CSV", names + "\n" + row + "\n"},
      {"plus.csv", names + "\n+5.0e-01,+2.5e-01,+1e-3,+0.0,+1e-3,+1e-1,-5e-2\n"},
      {"quoted.csv", "\"u\",\"v\",\"cuu\",\"cuv\",\"cvv\",\"s\",\"t\"\n" + row + "\n"},
      {"row_names.csv", "\"\",\"u\",\"v\",\"cuu\",\"cuv\",\"cvv\",\"s\",\"t\"\n\"1\"," + row + "\n"},
      {"index.csv", "," + names + "\n0," + row + "\n"},
      {"comments.csv", "# made today\n# " + names + "\n" + row + "\n# the end\n"},
      {"comment_above.csv", "# made today\n" + names + "\n" + row + "\n"},
      {"blanks.csv", "# " + blanks(names, ' ') + "  " + blanks(row, ' ')},
      {"tabs.csv", blanks(names, '\t') + blanks(row, '\t')},
      {"semicolons.csv", blanks(names, ';') + blanks(row, ';')}};
  for (const auto& [file, content] : files) {
    ASSERT_EQ(refusal(file, content), "accepted") << file;
    const QueryTable table(path(file), 0.01);
    ASSERT_EQ(table.size(), 1u) << file;
    EXPECT_EQ(table.query(0).footprint.mean_uv, Eigen::Vector2d(0.5, 0.25)) << file;
    EXPECT_EQ(table.query(0).half_vector, Eigen::Vector2d(0.1, -0.05)) << file;
  }
  std::filesystem::create_directory(path("folder.csv"));
  EXPECT_THROW(QueryTable(path("folder.csv"), 0.01), FileError);
}

TEST_F(QueryTables, ArraysMayBeBigEndianAndOfPython2) {
  const std::vector<double> values = {0.5, 0.25, 1e-3, 0, 1e-3, 0.1, -0.05};
  std::string data(reinterpret_cast<const char*>(values.data()), 7 * 8), swapped;
  for (std::size_t n = 0; n < 7; ++n)
    swapped.append(data.rend() - static_cast<long>(8 * n) - 8, data.rend() - static_cast<long>(8 * n));
  for (const std::string& bytes :
       {npy_bytes("<f8", false, "(1L, 7L)", data), npy_bytes(">f8", false, "(1, 7)", swapped)}) {
    ASSERT_EQ(refusal("a.npy", bytes), "accepted");
    EXPECT_EQ(QueryTable(path("a.npy"), 0.01).query(0).half_vector, Eigen::Vector2d(0.1, -0.05));
  }
}

/// Arrays of 14 columns: the lobe's covariance and the half vector's turn.
TEST_F(QueryTables, HoldTheFirstOrder) {
  Rows rows = query_rows(2);
  for (std::vector<double>& row : rows)
    for (const double value : {4e-4, 1e-4, 9e-4, 1.0, -2.0, 3.0, 0.5}) row.push_back(value);
  std::ofstream(path("q.npy"), std::ios::binary) << npy_of(rows);
  const QueryTable table(path("q.npy"), {});
  const Query query = table.query(1);
  ASSERT_TRUE(query.lobe_cov);
  EXPECT_EQ((*query.lobe_cov)(0, 0), 4e-4);
  EXPECT_EQ((*query.lobe_cov)(0, 1), 1e-4);
  EXPECT_EQ((*query.lobe_cov)(1, 0), 1e-4);
  EXPECT_EQ((*query.lobe_cov)(1, 1), 9e-4);
  EXPECT_EQ(query.half_vector_turn(0, 0), 1);
  EXPECT_EQ(query.half_vector_turn(0, 1), -2);
  EXPECT_EQ(query.half_vector_turn(1, 0), 3);
  EXPECT_EQ(query.half_vector_turn(1, 1), 0.5);
}

/// A .csv file names its columns, in any order and any of the groups.
TEST_F(QueryTables, HoldTheGroupsThatTheHeaderNames) {
  const auto read = [&](const std::string& content) {
    std::ofstream(path("q.csv")) << content;
    return QueryTable(path("q.csv"), 0.5).query(0);
  };
  const Query turned = read("su,u,v,cuu,cuv,cvv,s,t,tv,tu,sv\n7,1,2,.3,0,5,.6,-.7,10,9,8\n");
  EXPECT_EQ(turned.roughness, 0.5);
  EXPECT_FALSE(turned.lobe_cov);
  EXPECT_EQ(turned.half_vector, Eigen::Vector2d(0.6, -0.7));
  EXPECT_EQ(turned.half_vector_turn, (Eigen::Matrix2d() << 7, 8, 9, 10).finished());
  const Query lobe = read("u,v,cuu,cuv,cvv,s,t,rtt,rst,rss\n1,2,.3,0,5,.6,-.7,3,2,4\n");
  ASSERT_TRUE(lobe.lobe_cov);
  EXPECT_EQ(*lobe.lobe_cov, (Eigen::Matrix2d() << 4, 2, 2, 3).finished());
  EXPECT_TRUE(lobe.half_vector_turn.isZero(0));
  const Query rough = read("u,v,cuu,cuv,cvv,s,t,tv,roughness,tu,su,sv\n1,2,.3,0,5,.6,-.7,10,.04,9,7,8\n");
  EXPECT_EQ(rough.roughness, 0.04);
  EXPECT_EQ(rough.half_vector_turn, (Eigen::Matrix2d() << 7, 8, 9, 10).finished());
}

TEST_F(QueryTables, RefuseHalvesOfTheFirstOrder) {
  const std::string header = "u,v,cuu,cuv,cvv,s,t";
  expect_refusal("t.csv", header + ",su,sv,tu\n", "usage", "t.csv:1: column tv is missing");
  expect_refusal("t.csv", header + ",rss,rtt\n", "usage", "t.csv:1: column rst is missing");
  expect_refusal("t.csv", header + ",roughness,rss,rst,rtt\n0,0,1,0,1,0,0,.1,1,0,1\n", "usage",
                 "has both roughness and rss, rst, rtt");
  expect_refusal("a.npy", npy_bytes("<f8", false, "(10, 14)", std::string(10 * 14 * 8, '\0')), "usage",
                 "row 0: covariance is not positive definite");
  expect_refusal("a.npy", npy_bytes("<f8", false, "(14, 10)", std::string(10 * 14 * 8, '\0')), "usage",
                 "10 columns; expected one of");
}

TEST_F(QueryTables, NameRowsOfWhichTheFirstOrderIsBad) {
  const auto expect_row = [&](std::size_t column, double value, const std::string& message) {
    Rows table = rows(3);
    for (std::vector<double>& row : table)
      for (const double good : {1e-4, 0.0, 4e-4, 0.1, 0.0, 0.0, 0.1}) row.push_back(good);
    EXPECT_EQ(refusal("q.npy", npy_of(table)), "accepted");
    table[2][column] = value;
    expect_refusal("q.npy", npy_of(table), "usage", "row 2: " + message);
  };
  expect_row(7, std::nan(""), "lobe is not finite");
  expect_row(7, -1e-4, "lobe is not positive definite");
  expect_row(8, 1, "lobe is not positive definite");
  expect_row(7, 1e-12, "lobe of");
  expect_row(9, 2, "lobe of");
  expect_row(10, std::numeric_limits<double>::infinity(), "turn of the half vector is not finite");
  expect_row(12, 1e4, "half vector turns by");
}

/// More values than are read at once, in both orders.
TEST_F(QueryTables, ReadLargeArraysInEitherOrder) {
  constexpr std::size_t count = 30000, columns = 7;
  std::vector<float> by_row(count * columns), by_column(count * columns);
  for (std::size_t row = 0; row < count; ++row) {
    for (std::size_t column = 0; column < columns; ++column)
      by_row[row * columns + column] = by_column[column * count + row] =
          static_cast<float>(100 * row + column);
  }
  std::ofstream(path("c.npy"), std::ios::binary) << npy_bytes("<f4", false, "(30000, 7)", bytes_of(by_row));
  std::ofstream(path("f.npy"), std::ios::binary) << npy_bytes("<f4", true, "(30000, 7)", bytes_of(by_column));
  const auto values = [&](const char* file) {
    const auto rows = open_npy(path(file));
    return rows->read(0, rows->rows());
  };
  const std::vector<double> c = values("c.npy"), f = values("f.npy");
  EXPECT_EQ(c, f);
  EXPECT_EQ(c[29999 * columns + 6], 100 * 29999 + 6);
  for (const char* file : {"c.npy", "f.npy"})  // some rows are where they are in all
    EXPECT_EQ(open_npy(path(file))->read(20000, 300),
              std::vector<double>(c.begin() + 20000 * columns, c.begin() + 20300 * columns));
}

}  // namespace
}  // namespace mica::host::app::query_table_test
