#include "host/engine/gather_light.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/engine/surface_light.h"
#include "host/scene/low_discrepancy.h"
#include "host/surface/random.h"

namespace mica {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// Independent random numbers of one point.
enum Stream : std::uint64_t { kLightScramble, kCosineScramble, kBrdfKey, kCosinePath, kBrdfPath };

Eigen::Vector3d cosine_direction(const Eigen::Vector2d& uniform) {
  const double radius = std::sqrt(uniform.x()), azimuth = 2 * pi * uniform.y();
  return {radius * std::cos(azimuth), radius * std::sin(azimuth), std::sqrt(1 - uniform.x())};
}

/// A direction that was drawn by where light comes from, and that the point sees.
struct LightDraw {
  Eigen::Vector3d local;  ///< unit, in the point's frame
  Color radiance;         ///< into the pixel per unit of what reflects it
  double pdf;
};

/// What one point gathers.
class PointLight {
 public:
  PointLight(const BuiltJob& built, const LitPoint& point, std::uint64_t key)
      : built_(built), point_(point), material_(built.scene().materials()[point.material]), key_(key) {}

  const LitPoint& point() const { return point_; }
  const std::vector<LightDraw>& draws() const { return draws_; }

  /// Draws directions towards the light; the diffuse lobe is then done.
  void draw() {
    const int samples = built_.job().image.samples;
    const bool shines = !built_.scene().environment().is_black();
    for (int n = 0; n < samples && shines && uses_lights(); ++n) draw_light(static_cast<std::uint32_t>(n));
    for (int n = 0; n < samples && uses_brdf() && is_diffuse(); ++n)
      draw_cosine(static_cast<std::uint32_t>(n));
  }

  BrdfQuery query(const LightDraw& draw) const {
    return {point_.footprint, view(), draw.local, material_.roughness};
  }
  SampleQuery sample_query(std::size_t n) const {
    return {{point_.footprint, view(), material_.roughness}, synthesis::random_bits(key_, kBrdfKey, n)};
  }

  /// Adds the answer to query(draw).
  void add(const LightDraw& draw, const BrdfValue& value) {
    const BounceFresnel fresnel(material_.specular, view(), draw.local);
    const Color reflected = value.single * fresnel.single + value.multiple * fresnel.multiple;
    sum_ += reflected.cwiseProduct(draw.radiance) / (draw.pdf + (uses_brdf() ? value.pdf : 0));
  }

  /// Adds what comes from direction `n` that the BRDF drew.
  void add(const BrdfSample& sample, std::size_t n) {
    if (!(sample.pdf > 0)) return;
    const Eigen::Vector3d local = sample.light.cast<double>();
    const Color radiance = drawn_radiance(local, sample.pdf, synthesis::random_bits(key_, kBrdfPath, n));
    if (radiance.isZero(0)) return;
    const BounceFresnel fresnel(material_.specular, view(), local);
    const Color weight = sample.weight_single * fresnel.single + sample.weight_multiple * fresnel.multiple;
    sum_ += weight.cwiseProduct(radiance);
  }

  const Color& sum() const { return sum_; }

 private:
  bool uses_lights() const { return built_.plan().techniques != Techniques::brdf; }
  bool uses_brdf() const { return built_.plan().techniques != Techniques::lights; }
  bool is_diffuse() const { return material_.diffuse.maxCoeff() > 0; }
  Eigen::Vector3d view() const { return point_.frame.to_local(point_.to_eye); }

  bool faces(const Eigen::Vector3d& world) const {
    return world.dot(point_.frame.z) >= min_cosine && world.dot(point_.frame.face_normal) >= min_cosine;
  }

  /// Share of one draw in the mean over the pixel.
  double share() const {
    const ImageSettings& image = built_.job().image;
    return 1 / (static_cast<double>(image.samples) * image.subpixels * image.subpixels);
  }

  /// The share of a draw in the environment's radiance; zero where the point does not see it.
  Color seen_radiance(const Eigen::Vector3d& world) const {
    if (!faces(world)) return Color::Zero();
    const Color radiance = built_.scene().environment().radiance(world);
    if (radiance.isZero(0) || built_.scene().geometry().occluded(point_.hit, world, kFar))
      return Color::Zero();
    return share() * radiance;
  }

  /// What comes from a direction that the material drew with a density of `pdf`: from afar, weighted against
  /// the draws towards the light, or from another surface.
  Color drawn_radiance(const Eigen::Vector3d& local, double pdf, std::uint64_t path) const {
    const Eigen::Vector3d world = point_.frame.to_world(local);
    const Color radiance = seen_radiance(world);
    const int bounces = built_.job().image.max_bounces - 1;
    if (radiance.isZero(0) && bounces > 0 && faces(world))
      return share() * surface_light(built_.scene(), ray_from(point_.hit, world), bounces, path);
    return radiance * (pdf / (pdf + (uses_lights() ? built_.scene().environment().pdf(world) : 0)));
  }

  void draw_light(std::uint32_t n) {
    const Environment& environment = built_.scene().environment();
    const std::uint64_t scramble = synthesis::random_bits(key_, kLightScramble, 0);
    const Eigen::Vector3d world = environment.sample(low_discrepancy_point(n, scramble));
    const LightDraw draw{point_.frame.to_local(world), seen_radiance(world), environment.pdf(world)};
    if (draw.radiance.isZero(0) || !(draw.pdf > 0)) return;
    const double cosine_pdf = uses_brdf() ? draw.local.z() / pi : 0;
    sum_ += material_.diffuse.cwiseProduct(draw.radiance) * (draw.local.z() / pi / (draw.pdf + cosine_pdf));
    draws_.push_back(draw);
  }

  void draw_cosine(std::uint32_t n) {
    const std::uint64_t scramble = synthesis::random_bits(key_, kCosineScramble, 0);
    const Eigen::Vector3d local = cosine_direction(low_discrepancy_point(n, scramble));
    sum_ += material_.diffuse.cwiseProduct(
        drawn_radiance(local, local.z() / pi, synthesis::random_bits(key_, kCosinePath, n)));
  }

  const BuiltJob& built_;
  const LitPoint& point_;
  const MaterialDescription& material_;
  std::uint64_t key_;
  std::vector<LightDraw> draws_;
  Color sum_ = Color::Zero();
};

/// Asks one BRDF about all draws of its points, and lets it draw. @return how many questions that were.
std::size_t ask(PatchBrdf& brdf, int samples, bool draws, const std::vector<PointLight*>& points) {
  std::vector<BrdfQuery> queries;
  for (const PointLight* point : points)
    for (const LightDraw& draw : point->draws()) queries.push_back(point->query(draw));
  const std::vector<BrdfValue> values = brdf.evaluate(queries);
  std::size_t next = 0;
  for (PointLight* point : points)
    for (const LightDraw& draw : point->draws()) point->add(draw, values[next++]);
  if (!draws) return queries.size();

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

/// Gathers at points [first, last), and adds what they gather to `radiance`, a pixel.
std::size_t gather(const BuiltJob& built, const TracedRows& rows, std::size_t first, std::size_t last,
                   std::vector<Color>* radiance) {
  const ImageSettings& image = built.job().image;
  std::vector<PointLight> points;
  points.reserve(last - first);
  for (std::size_t n = first; n < last; ++n) {
    const LitPoint& point = rows.points[n];
    const std::uint64_t pixel = static_cast<std::uint64_t>(rows.first_row) * image.width + point.pixel;
    points.emplace_back(built, point, synthesis::random_bits(built.job().seed, pixel, point.subpixel));
  }
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t n) { points[n].draw(); });

  std::vector<std::vector<PointLight*>> of_brdf(built.plan().evaluators.size());
  for (PointLight& point : points)
    of_brdf[built.plan().evaluator_of_material[point.point().material]].push_back(&point);
  std::size_t questions = 0;
  const bool draws = built.plan().techniques != Techniques::lights;
  for (std::size_t n = 0; n < of_brdf.size(); ++n)
    if (!of_brdf[n].empty()) questions += ask(built.brdf(n), image.samples, draws, of_brdf[n]);
  for (const PointLight& point : points) (*radiance)[point.point().pixel] += point.sum();
  return questions;
}

}  // namespace

std::size_t gather_light(const BuiltJob& built, TracedRows* rows) {
  const std::size_t points_a_batch = std::max<std::size_t>(
      1, built.plan().queries_a_batch / static_cast<std::size_t>(built.job().image.samples));
  std::vector<Color> radiance(rows->radiance.size(), Color::Zero());
  std::size_t questions = 0;
  for (std::size_t first = 0; first < rows->points.size(); first += points_a_batch) {
    const std::size_t last = std::min(first + points_a_batch, rows->points.size());
    questions += gather(built, *rows, first, last, &radiance);
  }
  for (std::size_t pixel = 0; pixel < radiance.size(); ++pixel)
    rows->radiance[pixel] += radiance[pixel].cast<float>();
  std::vector<LitPoint>().swap(rows->points);
  return questions;
}

std::size_t add_lit_brdfs(const BuiltJob& built, TracedRows* rows) {
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
  std::vector<Color> radiance(rows->radiance.size(), Color::Zero());
  for (std::size_t n = 0; n < count; ++n) {
    const LitBrdf& lit = rows->lit[n];
    radiance[lit.pixel] += values[n].single * lit.weight_single.cast<double>() +
                           values[n].multiple * lit.weight_multiple.cast<double>();
  }
  for (std::size_t pixel = 0; pixel < radiance.size(); ++pixel)
    rows->radiance[pixel] += radiance[pixel].cast<float>();
  std::vector<LitBrdf>().swap(rows->lit);
  return count;
}

}  // namespace mica
