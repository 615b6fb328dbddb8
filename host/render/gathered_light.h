#pragma once

#include <cstdint>
#include <vector>

#include "host/base/query.h"
#include "host/job/job.h"
#include "host/methods/normal_draws.h"
#include "host/methods/patch_brdf.h"
#include "host/render/plan.h"
#include "host/scene/coat_crossing.h"
#include "host/scene/scene.h"
#include "host/scene/smooth_material.h"

namespace mica::host {

/// A direction that light comes from, and that the point sees.
struct LightDraw {
  Eigen::Vector3d local;  ///< unit, in the point's frame
  Color radiance;         ///< into the sample per unit of what reflects it
  double pdf;             ///< with which it is drawn by where light comes from
};

/// What all random numbers of a point are hashes of.
struct GatheringKeys {
  std::uint64_t pixel, point;
};

/// What the points of a job have in common.
struct GatheringContext {
  const Scene& scene;
  const ImageSettings& image;
  Techniques techniques;
};

/// Gathers the light that one point reflects into its sample. Two steps: `draw` does all that needs no answer
/// of the material's BRDF; then the answers are added, in any order that is always the same.
class GatheredLight {
 public:
  /// @param normals of the material's BRDF; null: it has none. All but `keys` must outlive this.
  GatheredLight(const GatheringContext& context, const LitPoint& point, const NormalDraws* normals,
                const GatheringKeys& keys);

  const LitPoint& point() const { return point_; }

  /// Draws directions towards the light; what the lobes without glints reflect is then done, and what normals
  /// mirror of all but the bright parts of the environment.
  void draw();
  const std::vector<LightDraw>& draws() const { return draws_; }

  /// Questions to the material's BRDF: about a draw, and for direction `n` of its own.
  BrdfQuery query(const LightDraw& draw) const;
  SampleQuery sample_query(std::size_t n) const;

  /// Adds the answers.
  void add(const LightDraw& draw, const BrdfValue& value);
  void add(const BrdfSample& sample, std::size_t n);

  /// Radiance into the sample.
  const Color& sum() const { return sum_; }

 private:
  bool uses_lights() const { return context_.techniques != Techniques::brdf; }
  bool uses_brdf() const { return context_.techniques != Techniques::lights; }
  bool faces(const Eigen::Vector3d& world) const;
  double share() const;
  Color tint(const Eigen::Vector3f& of_facets) const;
  Color seen_radiance(const Eigen::Vector3d& world) const;
  Color bounced_radiance(const Eigen::Vector3d& world, std::uint64_t path) const;
  Color drawn_radiance(const Eigen::Vector3d& local, double pdf, std::uint64_t path) const;
  void draw_light(std::uint32_t n);
  void draw_smooth(std::uint32_t n);
  void draw_normal(std::uint32_t n);
  std::uint32_t place_in_pixel(std::uint32_t n) const;
  bool asks_about(double light_pdf) const;
  double brdf_pdf(const LightDraw& draw, const BrdfValue& value) const;

  const GatheringContext& context_;
  const LitPoint& point_;
  const LayeredMaterial& layers_;
  const NormalDraws* normals_;
  GatheringKeys keys_;
  Eigen::Vector3d view_;  // in the point's frame
  CoatCrossing crossing_;
  SmoothMaterial smooth_;
  bool has_smooth_;  // this point has the light of `smooth_`
  std::vector<LightDraw> draws_;
  Color sum_ = Color::Zero();
};

}  // namespace mica::host
