#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "host/scene/background.h"
#include "host/scene/camera.h"
#include "host/scene/environment.h"
#include "host/scene/geometry.h"
#include "host/scene/glint_material.h"
#include "host/scene/layered_material.h"
#include "host/scene/lobes.h"
#include "host/scene/part_materials.h"
#include "host/scene/scene.h"
#include "host/scene/shading.h"

namespace mica::host {

/// What does not change from frame to frame.
struct StaticScene {
  Findings findings;  ///< about images of backgrounds and environments
  Geometry geometry;
  Background background;
  Environment environment;
  bool shows_environment;  ///< where rays hit nothing
  std::vector<MaterialDescription> materials;
  PartMaterials part_materials;
  std::vector<std::optional<GlintMaterial>> glints;  ///< one a material; only for those that are used

  explicit StaticScene(const SceneDescription& description);
  Color far_radiance(const Eigen::Vector3d& direction) const {
    return shows_environment ? environment.radiance(direction) : background.radiance(direction);
  }
};

/// A lamp seen from a point, or a part of a large one.
struct SeenLamp {
  std::uint32_t light = 0;       ///< its index
  bool is_above = false;         ///< the horizons, with any power; else nothing below is set
  double visible = 0;            ///< share of it that no shadow hides
  Illumination incident;         ///< of what is visible
  double missed = 0;             ///< as GlintQuery::missed_by_lamp
  double weight_unshadowed = 0;  ///< sum of the colours of what D would be multiplied with, without shadows
  LobesSeen seen;
  Eigen::Vector2d half_vector{0, 0};  ///< on the disk of the point's frame
  std::optional<Eigen::Matrix2d>
      lobe_cov;  ///< of its query, where the light's extent makes that longer one way
};

/// Whether two points look at the same lamps, cut into as many parts.
template <typename Lamp>
bool alike(const std::vector<Lamp>& a, const std::vector<Lamp>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(),
                                            [](const Lamp& x, const Lamp& y) { return x.light == y.light; });
}

/// How a point looks at lamps.
struct LampSampling {
  /// Where on a lamp the shadow rays end, see ShadowRays; of a lamp without extent the first one does.
  std::vector<Eigen::Vector2d> shadow_rays;
  LampParts parts;
};

/// What a ray of the camera meets. Without a hit the radiance is all.
struct SeenPoint {
  CameraRay ray;
  std::optional<Hit> hit;
  std::uint32_t material = 0;
  TangentFrame frame;
  Eigen::Vector3d to_eye;
  Eigen::Vector2d uv{0, 0};                       ///< of the map, repeat applied, not wrapped
  Eigen::Matrix2d duv = Eigen::Matrix2d::Zero();  ///< its change a pixel to the right and down
  bool faces_eye = false;                         ///< else it sends nothing
  Color radiance = Color::Zero();                 ///< of what needs no P-NDF
  std::vector<SeenLamp> lamps;                    ///< by light and part; empty where nothing is lit
};

/// The queries of rows, each row for itself.
struct RowQueries {
  std::vector<GlintQuery> glints;
  std::vector<LitPoint> points;
  std::vector<LitBrdf> lit;
  std::vector<LampSample> lamp_samples;

  std::size_t size() const { return glints.size() + lit.size(); }
};

/// Where the queries of a point belong.
struct SamplePlace {
  std::uint32_t pixel = 0, sample = 0;  ///< as in GlintQuery
  std::uint64_t key = 0;                ///< as in LitPoint
  std::uint32_t subpixel = 0;
  float missed = 0;  ///< as GlintQuery::missed_by_footprint
  /// A light: of those that shadows hide from the point, what they would show is asked. Empty: of none.
  std::vector<bool> asked_if_hidden = {};
};

/// A scene from one camera under some lights: single rays of it.
struct Viewer {
  std::shared_ptr<const StaticScene> shared;
  PinholeCamera camera;
  std::shared_ptr<const LayeredMaterials> layers;  ///< one a material
  std::vector<LightDescription> lights;
  LightGathering gathering;

  /// The ray through (x, y), pixels from the left and from the top edge.
  SeenPoint look(double x, double y, const LampSampling& sampling) const;

  /// Sees all lamps from a point that faces the eye, whose lamps and radiance are empty.
  void see_lamps(const LampSampling& sampling, SeenPoint* point) const;

  /// Adds what a Gaussian of `sigma_pixels` about a point that faces the eye has to be asked.
  /// @param turns of the half vector by lamp, per unit of uv; empty: they are constant.
  void ask(const SeenPoint& point, double sigma_pixels, const SamplePlace& place,
           const std::vector<Eigen::Matrix2d>& turns, RowQueries* queries) const;

 private:
  bool is_above(const Illumination& incident, const SeenPoint& point) const;
  double visible_share(const LightDescription& light, const SeenPoint& point,
                       const std::vector<Eigen::Vector2d>& shadow_rays) const;
  SeenLamp see(const Illumination& incident, double visible, const SeenPoint& point) const;
  double lobes_across(const SeenLamp& lamp, const SeenPoint& point) const;
  void gather(const SeenPoint& point, const std::vector<GlintPlace>& places, const SamplePlace& place,
              std::vector<LitPoint>* points) const;
  LitBrdf lit_brdf(const GlintQuery& query, const SeenPoint& point, const Illumination& incident) const;
};

}  // namespace mica::host
