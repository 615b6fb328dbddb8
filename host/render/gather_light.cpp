#include "host/render/gather_light.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "host/base/random.h"
#include "host/methods/ndf_brdf.h"
#include "host/render/gathered_light.h"

namespace mica::host {
namespace {

constexpr std::uint64_t kFrames = ~std::uint64_t{0};  // a stream that no pixel has
constexpr std::uint64_t kWholePixel = 0xffffffffu;    // a stream that no subpixel has

/// The draws of normals of a BRDF that has them, or null.
const NormalDraws* normal_draws(const PatchBrdf& brdf) {
  const auto* ndf_brdf = dynamic_cast<const NdfBrdf*>(&brdf);
  return ndf_brdf ? ndf_brdf->normal_draws() : nullptr;
}

/// Asks one BRDF about all draws of its points, and lets it draw. @return how many questions that were.
std::size_t ask(PatchBrdf& brdf, int samples, bool draws, const std::vector<GatheredLight*>& points) {
  std::vector<BrdfQuery> queries;
  for (const GatheredLight* point : points)
    for (const LightDraw& draw : point->draws()) queries.push_back(point->query(draw));
  const std::vector<BrdfValue> values = brdf.evaluate(queries);
  std::size_t next = 0;
  for (GatheredLight* point : points)
    for (const LightDraw& draw : point->draws()) point->add(draw, values[next++]);
  if (!draws || normal_draws(brdf)) return queries.size();

  const auto samples_a_point = static_cast<std::size_t>(samples);
  std::vector<SampleQuery> sample_queries(points.size() * samples_a_point);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t n) {
    for (std::size_t k = 0; k < samples_a_point; ++k)
      sample_queries[n * samples_a_point + k] = points[n]->sample_query(k);
  });
  const std::vector<BrdfSample> drawn = brdf.sample(sample_queries);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t n) {
    for (std::size_t k = 0; k < samples_a_point; ++k) points[n]->add(drawn[n * samples_a_point + k], k);
  });
  return queries.size() + sample_queries.size();
}

/// What the random numbers of a frame are a hash of; at frame 0, where pictures without frames are, the seed.
std::uint64_t seed_of(const BuiltJob& built) {
  const auto frame = static_cast<std::uint64_t>(built.frame());
  return frame == 0 ? built.job().seed : random_bits(built.job().seed, kFrames, frame);
}

/// Gathers at points [first, last), and adds what they gather to `radiance`, a sample.
std::size_t gather(const BuiltJob& built, const TracedRows& rows, std::size_t first, std::size_t last,
                   std::vector<Color>* radiance) {
  const ImageSettings& image = built.job().image;
  const GatheringContext context{built.scene(), image, built.plan().techniques};
  const std::uint64_t seed = seed_of(built);
  std::vector<const NormalDraws*> normals;
  for (std::size_t n = 0; n < built.plan().evaluators.size(); ++n)
    normals.push_back(normal_draws(built.brdf(n)));
  std::vector<GatheredLight> points;
  points.reserve(last - first);
  for (std::size_t n = first; n < last; ++n) {
    const LitPoint& point = rows.points[n];
    const std::uint64_t process = std::uint64_t{point.process} << 32;
    const GatheringKeys keys{random_bits(seed, point.key, kWholePixel + process),
                             random_bits(seed, point.key, point.subpixel + process)};
    const auto evaluator = static_cast<std::size_t>(built.plan().evaluator_of_material[point.material]);
    points.emplace_back(context, point, normals[evaluator], keys);
  }
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t n) { points[n].draw(); });

  std::vector<std::vector<GatheredLight*>> of_brdf(built.plan().evaluators.size());
  for (GatheredLight& point : points)
    of_brdf[built.plan().evaluator_of_material[point.point().material]].push_back(&point);
  std::size_t questions = 0;
  const bool draws = built.plan().techniques != Techniques::lights;
  for (std::size_t n = 0; n < of_brdf.size(); ++n)
    if (!of_brdf[n].empty()) questions += ask(built.brdf(n), image.samples, draws, of_brdf[n]);
  for (const GatheredLight& point : points) (*radiance)[point.point().sample] += point.sum();
  return questions;
}

}  // namespace

std::size_t gather_light(const BuiltJob& built, TracedRows* rows) {
  const std::size_t points_a_batch = std::max<std::size_t>(
      1, built.plan().queries_a_batch / static_cast<std::size_t>(built.job().image.samples));
  std::vector<Color> radiance(rows->sample_radiance.size(), Color::Zero());
  std::size_t questions = 0;
  for (std::size_t first = 0; first < rows->points.size(); first += points_a_batch) {
    const std::size_t last = std::min(first + points_a_batch, rows->points.size());
    questions += gather(built, *rows, first, last, &radiance);
  }
  for (std::size_t sample = 0; sample < radiance.size(); ++sample)
    rows->sample_radiance[sample] += radiance[sample].cast<float>();
  std::vector<LitPoint>().swap(rows->points);
  return questions;
}

std::size_t add_lit_brdfs(const BuiltJob& built, TracedRows* rows, const SeeLitBrdf& see) {
  const std::size_t count = rows->lit.size();
  std::vector<std::vector<std::size_t>> of_brdf(built.plan().evaluators.size());
  for (std::size_t n = 0; n < count; ++n)
    of_brdf[built.plan().evaluator_of_material[rows->lit[n].material]].push_back(n);
  std::vector<BrdfValue> values(count);
  for (std::size_t k = 0; k < of_brdf.size(); ++k) {
    std::vector<BrdfQuery> queries;
    for (const std::size_t n : of_brdf[k]) queries.push_back(rows->lit[n].query);
    if (queries.empty()) continue;
    const std::vector<BrdfValue> answers = built.brdf(k).evaluate(queries);
    for (std::size_t n = 0; n < answers.size(); ++n) values[of_brdf[k][n]] = answers[n];
  }
  std::vector<Color> radiance(rows->sample_radiance.size(), Color::Zero());
  for (std::size_t n = 0; n < count; ++n) {
    if (see) see(rows->lit[n], values[n]);
    const LitBrdf& lit = rows->lit[n];
    radiance[lit.sample] += values[n].single * lit.weight_single.cast<double>() +
                            values[n].multiple * lit.weight_multiple.cast<double>();
  }
  for (std::size_t sample = 0; sample < radiance.size(); ++sample)
    rows->sample_radiance[sample] += radiance[sample].cast<float>();
  std::vector<LitBrdf>().swap(rows->lit);
  return count;
}

}  // namespace mica::host
