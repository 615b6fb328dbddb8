// The page of `mica bench`: whole, by itself, and with everything on it.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/measure/suite.h"
#include "host/report/bench_report.h"
#include "host/report/chart.h"
#include "host/report/page_images.h"
#include "host/report/tolerance_curves.h"

namespace mica::host::page_test {
namespace {

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

/// Names of elements that are opened and not closed, or closed and not opened.
std::vector<std::string> unbalanced(const std::string& html) {
  const std::vector<std::string> empty = {"meta", "img", "br"};
  std::vector<std::string> open, wrong;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const std::size_t end = html.find('>', at);
    const std::string tag = html.substr(at + 1, end - at - 1),
                      name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag[0] == '!' || tag.back() == '/' || std::count(empty.begin(), empty.end(), name)) continue;
    if (tag[0] != '/') {
      open.push_back(name);
    } else if (!open.empty() && open.back() == tag.substr(1)) {
      open.pop_back();
    } else {
      wrong.push_back(tag);
    }
  }
  wrong.insert(wrong.end(), open.begin(), open.end());
  return wrong;
}

TEST(Base64, IsThatOfTheStandard) {  // RFC 4648, sec. 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(Markup, IsEscaped) {
  EXPECT_EQ(escape_markup("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
}

TEST(DifferencePixels, AreBlueWhiteAndOrange) {
  const std::vector<std::uint8_t> pixels = difference_pixels({0, 1, 2}, {1, 1, 1}, 1);
  EXPECT_EQ(pixels, (std::vector<std::uint8_t>{0, 114, 178, 255, 255, 255, 213, 94, 0}));
}

/// Draws, from four points, the two that none is both faster and closer than, and the one between.
TEST(Chart, DrawsTheParetoFront) {
  Chart chart;
  chart.pareto = true;
  chart.series = {{"a", {{1e3, 1e-6, "", ""}, {1e4, 1e-3, "", ""}}},
                  {"b", {{1e6, 1e-1, "", ""}, {1e3, 1e-2, "", ""}}}};
  const std::string svg = draw(chart);
  const std::size_t line = svg.find("<polyline");
  ASSERT_NE(line, std::string::npos);
  const std::string points = svg.substr(line, svg.find("fill", line) - line);
  EXPECT_EQ(count_of(points, ","), 3u) << points;
}

TEST(Chart, TakesNoPointsAtAll) {
  EXPECT_TRUE(unbalanced(draw(Chart{})).empty());
}

bench::Measurement measured(const char* evaluator, const char* knob, double tolerance, double speed,
                            double error) {
  bench::Measurement m;
  m.evaluator = m.label = evaluator, m.knob = knob, m.tolerance = tolerance;
  m.speed.median = speed, m.errors.relative_l2 = error;
  return m;
}

/// By tolerance, over the evaluator's own speed; without evaluators that have no tolerances, what was
/// refused, and other evaluators' knobs.
TEST(ToleranceCurves, AreRatiosToExactAnswersOfTheSameCell) {
  bench::Results results;
  bench::Cell cell{"flat", 64, 8, 0.01, 1, {}};
  cell.measurements = {measured("a", "", 0, 200, 1e-6),          measured("a", "0.01", 0.01, 700, 8e-3),
                       measured("a", "0.001", 0.001, 300, 7e-4), measured("a", "0.1", 0.1, 900, 0.09),
                       measured("b", "", 0, 50, 1e-6),           measured("b", "2", 0, 60, 1e-6)};
  cell.measurements[3].refused = "for the test";
  results.cells = {{"other", 64, 8, 0.01, 1, {}}, cell};
  const std::vector<ToleranceCurve> curves = tolerance_curves(results);
  ASSERT_EQ(curves.size(), 1u);
  EXPECT_EQ(curves[0].cell, &results.cells[1]);
  std::vector<double> tolerances, ratios;
  for (const ToleranceCurve::Point& point : curves[0].points)
    tolerances.push_back(point.measured->tolerance), ratios.push_back(point.speed_ratio);
  EXPECT_EQ(tolerances, (std::vector<double>{0, 0.001, 0.01}));
  EXPECT_EQ(ratios, (std::vector<double>{1, 1.5, 3.5}));
  const std::string charts = tolerance_charts(results);
  EXPECT_TRUE(unbalanced(charts).empty());
  EXPECT_EQ(count_of(charts, "<svg"), 1u);
  EXPECT_EQ(count_of(charts, "3.50 times the speed"), 1u);
  EXPECT_EQ(count_of(tolerance_summary(results), "0.01: 3.50x 8.0e-03"), 1u);
  results.cells.pop_back();
  EXPECT_EQ(tolerance_charts(results) + tolerance_summary(results), "");
}

/// The smallest suite, from the device to the page.
TEST(BenchPage, StandsByItself) {
  Device device(0);
  std::vector<std::string> steps;
  const bench::Results results =
      bench::run_suite("tiny", device, [&](const std::string& what) { steps.push_back(what); });
  EXPECT_GT(steps.size(), 10u);
  const std::string page = bench_page(results);
  EXPECT_TRUE(unbalanced(page).empty()) << unbalanced(page).front();
  EXPECT_EQ(count_of(page, "http"),
            count_of(page, "xmlns=\"http://www.w3.org/2000/svg\""));  // nothing from elsewhere
  EXPECT_EQ(count_of(page, "src="), count_of(page, "src=\"data:image/png;base64,"));
  EXPECT_EQ(count_of(page, "nan"), 0u);
  std::size_t images = 1 + 3 * results.pictures.size();
  for (const bench::ThumbnailRow& row : results.thumbnails) images += 2 * row.thumbnails.size() - 1;
  EXPECT_EQ(count_of(page, "<img"), images);

  const nlohmann::json json = nlohmann::json::parse(bench_json(results));
  EXPECT_EQ(json.at("suite"), "tiny");
  for (const nlohmann::json& cell : json.at("cells")) {
    for (const nlohmann::json& m : cell.at("measurements")) {
      if (m.contains("refused")) continue;
      EXPECT_GT(m.at("queries_per_second").at("slowest"), 0);
      EXPECT_LE(m.at("queries_per_second").at("slowest"), m.at("queries_per_second").at("median"));
      EXPECT_LE(m.at("queries_per_second").at("median"), m.at("queries_per_second").at("fastest"));
      EXPECT_GT(m.at("device_bytes"), 0) << m;
    }
    const nlohmann::json& triangles = cell.at("measurements").at(0);
    EXPECT_EQ(triangles.at("evaluator"), "triangles");
    EXPECT_LT(triangles.at("errors").at("relative_l2"), 1e-4);
  }
  ASSERT_EQ(json.at("tolerance_curves").size(), json.at("cells").size());
  for (const nlohmann::json& curve : json.at("tolerance_curves")) {
    std::vector<double> tolerances;
    for (const nlohmann::json& point : curve.at("points"))
      if (!point.at("tolerance").is_null()) tolerances.push_back(point.at("tolerance"));
    EXPECT_EQ(tolerances, (std::vector<double>{3e-4, 1e-3, 3e-3, 1e-2, 3e-2}));
    EXPECT_LT(curve.at("points").at(0).at("relative_l2"), 1e-4);
    EXPECT_GT(curve.at("points").at(5).at("relative_l2"), 1e-4) << "as if nothing had been left out";
  }
  EXPECT_LT(json.at("pictures").at(0).at("evaluator").at("relative_mse"), 1e-8);
  EXPECT_GT(json.at("pictures").at(0).at("equal_time").at("relative_mse"), 1e-6);
}

}  // namespace
}  // namespace mica::host::page_test
