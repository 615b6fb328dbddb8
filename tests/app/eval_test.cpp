// `mica eval`: the same densities from any form of the same table.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/reference/glint_grid.h"
#include "tests/app/command.h"

namespace mica::host::app::eval_test {
namespace {

class Eval : public CommandTest {
 protected:
  Eval() { write_map(); }

  /// Densities of a file of queries.
  std::vector<float> eval(const std::string& queries,
                          const std::string& options = "--ndf triangles --roughness 0.01",
                          const std::string& before = "") {
    const Outcome outcome = mica("eval --map map.exr -o D.npy --queries " + queries + " " + options, before);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    return densities("D.npy");
  }
};

std::string csv_of(const Rows& rows, const std::string& header) {
  std::string text = header + "\n";
  for (const std::vector<double>& row : rows) {
    for (std::size_t n = 0; n < row.size(); ++n) {
      char number[32];
      std::snprintf(number, sizeof number, "%s%.17g", n ? "," : "", row[n]);
      text += number;
    }
    text += "\n";
  }
  return text;
}

TEST_F(Eval, DensitiesAreThoseOfTheReference) {
  write("q.npy", npy_of(query_rows(200)));
  const std::vector<float> device = eval("q.npy"),
                           reference = eval("q.npy", "--ndf reference --roughness 0.01");
  ASSERT_EQ(device.size(), 200u);
  ASSERT_EQ(reference.size(), 200u);
  const float peak = *std::max_element(reference.begin(), reference.end());
  EXPECT_GT(peak, 100);  // some queries lie on normals
  for (std::size_t n = 0; n < device.size(); ++n)
    EXPECT_NEAR(device[n], reference[n], 1e-4 * reference[n] + 1e-6 * peak) << "row " << n;
}

/// 14 columns: half vectors that turn, and lobes that are not round.
TEST_F(Eval, DensitiesOfTheFirstOrderAreThoseOfTheReference) {
  Rows rows = query_rows(100);
  for (std::vector<double>& row : rows)
    for (const double value : {1e-4, 3e-5, 4e-5, 0.2, -0.1, 0.15, 0.3}) row.push_back(value);
  write("q.npy", npy_of(rows));
  write("q.csv", csv_of(rows, "u,v,cuu,cuv,cvv,s,t,rss,rst,rtt,su,sv,tu,tv"));
  const std::vector<float> device = eval("q.npy", "--ndf triangles"),
                           reference = eval("q.npy", "--ndf reference");
  ASSERT_EQ(device.size(), 100u);
  ASSERT_EQ(reference.size(), 100u);
  const float peak = *std::max_element(reference.begin(), reference.end());
  EXPECT_GT(peak, 100);
  for (std::size_t n = 0; n < device.size(); ++n)
    EXPECT_NEAR(device[n], reference[n], 1e-4 * reference[n] + 1e-6 * peak) << "row " << n;
  EXPECT_EQ(eval("q.csv", "--ndf triangles"), device);
  const Outcome refused = mica("eval --map map.exr -o E.npy --queries q.npy --ndf beckmanns");
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("beckmanns takes no turn"), std::string::npos) << refused.err;
}

TEST_F(Eval, EveryFormOfATableGivesTheSame) {
  const Rows rows = query_rows(100);
  std::vector<double> by_column;
  for (std::size_t column = 0; column < 7; ++column)
    for (const std::vector<double>& row : rows) by_column.push_back(row[column]);
  write("c.npy", npy_of(rows));
  write("fortran.npy", npy_bytes("<f8", true, "(100, 7)", bytes_of(by_column)));
  write("version_2.npy", npy_bytes("<f8", true, "(100, 7)", bytes_of(by_column), 2));
  write("version_3.npy", npy_bytes("<f8", true, "(100,7)", bytes_of(by_column), 3));
  write("q.csv", csv_of(rows, "u,v,cuu,cuv,cvv,s,t"));
  write("numpy.csv", csv_of(rows, "# u, v, cuu, cuv, cvv, s, t\r"));
  Rows turned = rows;
  for (std::vector<double>& row : turned) std::reverse(row.begin(), row.end());
  write("turned.csv", csv_of(turned, "t,s,cvv,cuv,cuu,v,u"));
  const std::vector<float> expected = eval("c.npy");
  for (const char* const file :
       {"fortran.npy", "version_2.npy", "version_3.npy", "q.csv", "numpy.csv", "turned.csv"})
    EXPECT_EQ(eval(file), expected) << file;
}

TEST_F(Eval, SinglePrecisionGivesTheSameForTheSameNumbers) {
  Rows rows = query_rows(100);
  for (std::vector<double>& row : rows)
    for (double& value : row) value = static_cast<float>(value);
  write("double.npy", npy_of(rows));
  write("single.npy", npy_of<float>(rows, "<f4"));
  EXPECT_EQ(eval("single.npy"), eval("double.npy"));
}

TEST_F(Eval, HalvesGiveWhatTheWholeGives) {
  const Rows rows = query_rows(1000);
  write("whole.npy", npy_of(rows));
  write("first.npy", npy_of(Rows(rows.begin(), rows.begin() + 377)));
  write("second.npy", npy_of(Rows(rows.begin() + 377, rows.end())));
  std::vector<float> halves = eval("first.npy");
  const std::vector<float> second = eval("second.npy");
  halves.insert(halves.end(), second.begin(), second.end());
  EXPECT_EQ(halves, eval("whole.npy"));
}

TEST_F(Eval, NoRowsGiveAnEmptyArray) {
  write("none.npy", npy_of({}));
  write("none.csv", "u,v,cuu,cuv,cvv,s,t\n");
  EXPECT_TRUE(eval("none.npy").empty());
  EXPECT_TRUE(eval("none.csv").empty());
}

TEST_F(Eval, ARoughnessInTheRowReplacesTheOption) {
  Rows rows = query_rows(50);
  write("without.npy", npy_of(rows));
  for (std::size_t n = 0; n < rows.size(); ++n) rows[n].push_back(n % 2 ? 0.01 : 0.03);
  write("with.npy", npy_of(rows));
  const std::vector<float> fine = eval("without.npy"),
                           coarse = eval("without.npy", "--ndf triangles --roughness 0.03");
  const std::vector<float> mixed = eval("with.npy", "--ndf triangles --roughness 0.5");
  EXPECT_EQ(eval("with.npy", "--ndf triangles"), mixed);
  EXPECT_NE(fine, coarse);
  for (std::size_t n = 0; n < rows.size(); ++n) EXPECT_EQ(mixed[n], n % 2 ? fine[n] : coarse[n]);
}

TEST_F(Eval, RepairsAMapWhenAskedAndSaysSo) {
  Image image{32, 32, {"R", "G", "B"}, to_signed_rgb(spectrum()), {}};
  image.pixels[300] = std::nanf("");
  write_exr(path("nan.exr"), image);
  write("q.npy", npy_of(query_rows(10)));
  const Outcome outcome =
      mica("eval --map nan.exr --invalid repair --ndf triangles --roughness 0.01 --queries q.npy -o D.npy");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("warning: "), std::string::npos) << outcome.err;
  EXPECT_EQ(densities("D.npy").size(), 10u);
}

TEST_F(Eval, TheReferenceNeedsNoDevice) {
  write("q.npy", npy_of(query_rows(10)));
  std::filesystem::create_directories(path("no_drivers"));
  EXPECT_EQ(eval("q.npy", "--ndf reference --roughness 0.01", "OCL_ICD_VENDORS=no_drivers").size(), 10u);
}

TEST_F(Eval, GlintsNeedNoMap) {
  const std::string arguments =
      "eval --ndf grid --alpha 0.3,0.2 --distribution beckmann --microroughness 0.02 --density 1e5 --stretch "
      "2 "
      "--seed 5 --queries rows.npy -o D.npy --json D.json";
  write("rows.npy", npy_of(query_rows(50)));
  const Outcome outcome = mica(arguments);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<float> densities = this->densities("D.npy");
  ASSERT_EQ(densities.size(), 50u);
  reference::GlintProcess process;
  process.beckmann = true, process.alpha_x = 0.3, process.alpha_y = 0.2;
  process.density = 1e5, process.stretch = 2, process.seed = 5;
  const Rows rows = query_rows(50);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    Query query;
    query.footprint.mean_uv = {rows[n][0], rows[n][1]};
    query.footprint.cov_uv << rows[n][2], rows[n][3], rows[n][3], rows[n][4];
    query.half_vector = {rows[n][5], rows[n][6]};
    query.roughness = 0.02;
    const double expected = process.density_of(query);
    EXPECT_NEAR(densities[n], expected, 1e-4 * expected + 1e-6 * process.smooth_density(query.half_vector))
        << n;
  }
  EXPECT_EQ(nlohmann::json::parse(bytes(path("D.json")))["glints"]["density"], 1e5);
}

TEST_F(Eval, GlintsAreDrawnAndWeighed) {
  const std::string common = "eval --ndf grid --alpha 0.3 --microroughness 0.05 --density 1e6 --queries ";
  Rows views;
  for (int n = 0; n < 200; ++n) views.push_back({0.01 * n, 0.3, 1e-6, 0, 1e-6, 0.3, 0, 0.9});
  write("views.npy", npy_of(views));
  Outcome outcome = mica(common + "views.npy --quantity sample -o draws.npy");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<float> draws = densities("draws.npy", 5);  // ix iy iz pdf weight
  ASSERT_EQ(draws.size(), 1000u);
  Rows lit;
  std::vector<float> expected;
  for (std::size_t n = 0; n < views.size(); ++n) {
    if (!(draws[5 * n + 3] > 0)) continue;
    lit.push_back(views[n]);
    for (std::size_t axis = 0; axis < 3; ++axis) lit.back().push_back(draws[5 * n + axis]);
    expected.push_back(draws[5 * n + 3] * draws[5 * n + 4]);
  }
  ASSERT_GT(lit.size(), 100u);
  write("lit.npy", npy_of(lit));
  outcome = mica(common + "lit.npy --quantity brdf -o brdf.npy");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<float> values = densities("brdf.npy");
  ASSERT_EQ(values.size(), expected.size());
  // The direction was rounded on the way, which moves it within a lobe.
  for (std::size_t n = 0; n < values.size(); ++n)
    EXPECT_NEAR(values[n], expected[n], 1e-3 * expected[n] + 1e-4);
}

TEST_F(Eval, SaysWhatItDid) {
  write("q.npy", npy_of(query_rows(10)));
  eval("q.npy", "--ndf triangles --roughness 0.01 --tolerance 1e-3 --json D.json");
  const nlohmann::json json = nlohmann::json::parse(bytes(path("D.json")));
  EXPECT_EQ(json.at("queries"), 10);
  EXPECT_EQ(json.at("evaluator"), "triangles");
  EXPECT_EQ(json.at("tolerance"), 1e-3);
  EXPECT_EQ(json.at("map").at("width"), 32);
  EXPECT_FALSE(json.at("map").at("notes").empty());  // the encoding was assumed
  EXPECT_FALSE(json.at("device").at("name").get<std::string>().empty());
  EXPECT_GT(json.at("device_bytes"), 32 * 32 * 8);
  for (const char* const phase : {"load", "build", "evaluate", "device"})
    EXPECT_GE(json.at("seconds").at(phase), 0) << phase;
  EXPECT_GT(json.at("queries_per_second"), 0);
}

TEST_F(Eval, StopsOnInterruptAndLeavesNoFile) {
  Rows rows(200000, query_rows(1)[0]);  // minutes of work for the reference
  for (std::vector<double>& row : rows) row[2] = row[4] = 0.02, row[3] = 0;
  write("q.npy", npy_of(rows));
  const std::set<std::string> before = files();
  const Outcome outcome = mica(
      "eval --map map.exr --interpolation bicubic --ndf reference --roughness 0.1 "
      "--queries q.npy -o D.npy",
      "timeout --preserve-status --signal INT 2");
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_EQ(files(), before);
}

}  // namespace
}  // namespace mica::host::app::eval_test
