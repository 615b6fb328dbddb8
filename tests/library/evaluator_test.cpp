#include "mica/evaluator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mica/brdf.h"
#include "mica/error.h"

namespace mica::evaluator_test {
namespace {

const Device& device() {
  static const Device shared;  // programs are built once for all tests
  return shared;
}

const NormalMap& noise() {
  static const NormalMap map = NormalMap::generate("spectrum", {{"resolution", 64}, {"rms_slope", 0.3}});
  return map;
}

std::vector<Query> some_queries(std::size_t count) {
  std::vector<Query> queries(count);
  for (std::size_t n = 0; n < count; ++n) {
    const double sigma = (1 + 0.01 * static_cast<double>(n % 300)) / 64;
    queries[n].u = 0.37 * static_cast<double>(n), queries[n].v = 0.21 * static_cast<double>(n);
    queries[n].cuu = queries[n].cvv = sigma * sigma, queries[n].cuv = 0.3 * sigma * sigma;
    queries[n].s = 0.2 * std::sin(static_cast<double>(n)),
    queries[n].t = 0.2 * std::cos(static_cast<double>(n));
    queries[n].roughness = 0.03;
  }
  return queries;
}

TEST(LibraryEvaluator, ReadsAnyLayoutOfTheCallersMemory) {
  const std::vector<Query> queries = some_queries(500);
  std::vector<double> rows, columns(8 * queries.size());
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const Query& q = queries[n];
    const double numbers[] = {q.u, q.v, q.cuu, q.cuv, q.cvv, q.s, q.t, q.roughness};
    rows.insert(rows.end(), std::begin(numbers), std::end(numbers));
    for (std::size_t k = 0; k < 8; ++k) columns[k * queries.size() + n] = numbers[k];
  }
  Queries separate;
  separate.count = queries.size();
  Column* const numbers[] = {&separate.u,   &separate.v, &separate.cuu, &separate.cuv,
                             &separate.cvv, &separate.s, &separate.t,   &separate.roughness};
  for (std::size_t k = 0; k < 8; ++k) *numbers[k] = Column(&columns[k * queries.size()]);

  const Evaluator evaluator(device(), noise(), "triangles");
  const std::vector<float> expected = evaluator.evaluate(queries);
  EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 1);
  EXPECT_EQ(evaluator.evaluate(Queries::of_rows(rows.data(), queries.size(), 8)), expected);
  EXPECT_EQ(evaluator.evaluate(separate), expected);
  std::vector<double> doubles(queries.size());
  evaluator.evaluate(queries, Span<double>(doubles));
  for (std::size_t n = 0; n < queries.size(); ++n) EXPECT_EQ(static_cast<float>(doubles[n]), expected[n]);
}

TEST(LibraryEvaluator, KeepsItsMapAndItsDevice) {
  std::unique_ptr<Evaluator> evaluator;
  {
    const Device own;
    const NormalMap map = NormalMap::generate("spectrum", {{"resolution", 32}});
    evaluator = std::make_unique<Evaluator>(own, map, "triangles");
  }
  EXPECT_EQ(evaluator->evaluate(some_queries(10)).size(), 10u);
}

TEST(LibraryEvaluator, RefusesWrongUse) {
  const Evaluator evaluator(device(), noise(), "triangles");
  std::vector<Query> queries = some_queries(4);
  std::vector<float> densities(3, -1);
  EXPECT_THROW(evaluator.evaluate(queries, Span<float>(densities)), UsageError);
  EXPECT_THROW(evaluator.evaluate(queries, Span<float>(nullptr, 4)), UsageError);
  EXPECT_THROW(evaluator.evaluate(Span<const Query>(nullptr, 4)), UsageError);
  EXPECT_THROW(Queries::of_rows(static_cast<const double*>(nullptr), 4, 8), UsageError);
  const double row[9] = {};
  EXPECT_THROW(Queries::of_rows(row, 1, 9), UsageError);
  Queries without_memory;
  without_memory.count = 2;
  without_memory.s = Column(static_cast<const float*>(nullptr));
  EXPECT_THROW(evaluator.evaluate(without_memory), UsageError);
  densities.assign(4, -1);
  queries[2].cuu = -1;
  try {
    evaluator.evaluate(queries, Span<float>(densities));
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("query 2"), std::string::npos) << error.what();
  }
  for (const float density : densities) EXPECT_EQ(density, -1) << "nothing is written";
  EXPECT_TRUE(evaluator.evaluate(std::vector<Query>()).empty());
}

TEST(LibraryEvaluator, RefusesUnknownNamesAndSettings) {
  EXPECT_THROW(Evaluator(device(), noise(), "triangle"), UsageError);
  EXPECT_THROW(Evaluator(device(), noise(), "cavities"), UsageError);  // it has no density
  EXPECT_THROW(Evaluator(device(), noise(), "grid"), UsageError);      // it has no map
  EXPECT_THROW(Evaluator(device(), "triangles"), UsageError);          // it has one
  EXPECT_THROW(Evaluator(device(), noise(), "gaussians", {{"element", 2}}), UsageError);
  EXPECT_THROW(Evaluator(device(), noise(), "gaussians", {{"elements", 9}}), UsageError);
  EXPECT_THROW(Evaluator(device(), noise(), "gaussians", {{"tolerance", 0.01}}), UsageError);
  EXPECT_THROW(Evaluator(device(), noise(), "auto", {{"tolerance", "small"}}), UsageError);
  EXPECT_THROW(Brdf(device(), noise(), "beckmanns", {{"masking", "none"}}), UsageError);
  EXPECT_THROW(Brdf(device(), noise(), "triangles"), UsageError);
  EXPECT_THROW(Device(1000), DeviceError);
}

TEST(LibraryEvaluator, RefusesWhatWasMovedFrom) {
  Device first;
  const Device second = std::move(first);
  EXPECT_THROW(first.info(), UsageError);  // NOLINT(bugprone-use-after-move): that is the test
  Evaluator evaluator(second, noise(), "triangles");
  const Evaluator moved = std::move(evaluator);
  EXPECT_THROW(evaluator.method(), UsageError);  // NOLINT(bugprone-use-after-move)
  NormalMap map = noise();
  const NormalMap kept = std::move(map);
  EXPECT_THROW(map.width(), UsageError);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(kept.width(), 64);
}

TEST(LibraryEvaluator, StopsWhenItIsCancelled) {
  const Evaluator evaluator(device(), noise(), "triangles");
  RunControl control;
  control.progress = [&](std::size_t, std::size_t) { control.cancellation.cancel(); };
  EXPECT_THROW(evaluator.evaluate(some_queries(20000), control), Cancelled);
  control = {};
  control.progress = [](std::size_t, std::size_t) { throw std::runtime_error("the caller's own"); };
  EXPECT_THROW(evaluator.evaluate(some_queries(10), control), std::runtime_error);
}

TEST(LibraryEvaluator, DrawsWhatItAnswers) {
  PndfWindow window;
  window.pixels = 16;
  std::vector<Query> queries = some_queries(2);
  for (const std::string method : {"triangles", "pyramid"}) {
    const Evaluator evaluator(device(), noise(), method);
    std::vector<float> images(2 * 16 * 16);
    evaluator.draw(Queries(queries), 0.05, window, Span<float>(images));
    for (std::size_t pixel : {120UL, 256UL + 90UL}) {
      Query query = queries[pixel / 256];
      query.s = (2.0 * static_cast<double>(pixel % 16) + 1) / 16 - 1;
      query.t = 1 - (2.0 * static_cast<double>(pixel % 256 / 16) + 1) / 16;
      query.roughness = 0.05;
      const float density = evaluator.evaluate(std::vector<Query>{query})[0];
      EXPECT_NEAR(images[pixel], density, 0.02 * density + 1e-3) << method;
    }
    EXPECT_THROW(evaluator.draw(Queries(queries), 0.05, window, Span<float>(images.data(), 7)), UsageError);
    window.pixels = 0;
    EXPECT_THROW(evaluator.draw(Queries(queries), 0.05, window, Span<float>(images)), UsageError);
    window.pixels = 16;
  }
}

TEST(LibraryEvaluator, TellsHowFarItsAnswersMayBeOff) {
  const std::vector<Query> queries = some_queries(300);
  const Evaluator triangles(device(), noise(), "triangles");
  const std::vector<float> densities = triangles.evaluate(queries);
  std::vector<float> errors(queries.size(), -1);
  triangles.estimate_errors(queries, Span<const float>(densities), Span<float>(errors));
  for (std::size_t n = 0; n < errors.size(); ++n) EXPECT_FLOAT_EQ(errors[n], 1e-4F * densities[n]);
  EXPECT_THROW(
      triangles.estimate_errors(queries, Span<const float>(densities.data(), 7), Span<float>(errors)),
      UsageError);
  EXPECT_THROW(
      triangles.estimate_errors(queries, Span<const float>(densities), Span<float>(errors.data(), 7)),
      UsageError);
  const Evaluator gaussians(device(), noise(), "gaussians");
  EXPECT_THROW(gaussians.estimate_errors(queries, Span<const float>(densities), Span<float>(errors)),
               UsageError);
}

TEST(LibraryBrdf, AnswersAndRefuses) {
  const Brdf brdf(device(), noise(), "beckmanns");
  Lightings queries;
  queries.count = 3;
  queries.cuu = queries.cvv = 1e-3;
  queries.ox = 0.3, queries.ix = -0.2;
  std::vector<float> values(3), albedos(6), samples(15);
  brdf.evaluate(queries, Span<float>(values));
  EXPECT_GT(values[0], 0);
  brdf.energy(queries, Span<float>(albedos));
  EXPECT_NEAR(albedos[0], 1, 0.2);
  brdf.sample(queries, 7, Span<float>(samples));
  EXPECT_GT(samples[3], 0);
  EXPECT_THROW(brdf.energy(queries, Span<float>(values)), UsageError);
  queries.ix = queries.iz = 0.0;
  EXPECT_THROW(brdf.evaluate(queries, Span<float>(values)), UsageError);  // a direction without length
}

TEST(LibraryMap, RefusesWhatIsNoMap) {
  const std::vector<float> numbers(2 * 16, 0.1F);
  EXPECT_EQ(NormalMap::from_normals(4, 4, numbers, 2).width(), 4);
  EXPECT_THROW(NormalMap::from_normals(4, 5, numbers, 2), UsageError);
  EXPECT_THROW(NormalMap::from_normals(0, 4, numbers, 2), UsageError);
  EXPECT_THROW(NormalMap::from_normals(4, 4, numbers, 4), UsageError);
  EXPECT_THROW(NormalMap::from_normals(4, 4, Span<const float>(nullptr, 32), 2), UsageError);
  std::vector<double> normals(3 * 16, 1.0);
  EXPECT_EQ(NormalMap::from_normals(4, 4, normals, 3).height(), 4);
  normals[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(NormalMap::from_normals(4, 4, normals, 3), UsageError);
  normals[5] = -1;
  EXPECT_THROW(NormalMap::from_normals(4, 4, normals, 3), UsageError);
  EXPECT_THROW(NormalMap::load("/nowhere/map.exr"), FileError);
  EXPECT_THROW(NormalMap::generate("spektrum"), UsageError);
  EXPECT_THROW(NormalMap::generate("spectrum", {{"rms_slope", 99}}), UsageError);
  EXPECT_THROW(NormalMap::generate("spectrum", {{"rms_slop", 0.1}}), UsageError);
}

TEST(LibraryMap, HasTheNormalsThatItWasGiven) {
  std::vector<double> normals(2 * 16), copy(2 * 16);
  for (std::size_t n = 0; n < normals.size(); ++n) normals[n] = 0.01 * static_cast<double>(n);
  const NormalMap map = NormalMap::from_normals(4, 4, normals, 2);
  map.copy_normals(Span<double>(copy));
  EXPECT_EQ(copy, normals);
  const Span<const double> in_place = map.normals();
  EXPECT_EQ(std::vector<double>(in_place.data, in_place.data + in_place.size), normals);
  EXPECT_EQ(NormalMap(map).normals().data, in_place.data) << "copies share the map";
  EXPECT_THROW(noise().copy_normals(Span<double>(copy)), UsageError);
}

}  // namespace
}  // namespace mica::evaluator_test
