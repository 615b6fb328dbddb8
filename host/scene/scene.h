#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "host/base/glints.h"
#include "host/base/query.h"
#include "host/scene/coat.h"
#include "host/scene/description.h"
#include "host/scene/environment.h"
#include "host/scene/geometry.h"
#include "host/scene/lit_point.h"

namespace mica::host {

/// One light seen in one footprint: the P-NDF to ask for, and what to multiply it with.
struct GlintQuery {
  Query query;                 ///< in the map's uv (repeat applied), roughness of the material
  std::uint32_t pixel = 0;     ///< row * width + column, from the first traced row
  std::uint32_t material = 0;  ///< index into SceneDescription::materials
  Eigen::Vector3f weight = Eigen::Vector3f::Zero();  ///< radiance into the pixel per unit of D
  GlintPoint glints;                                 ///< for the evaluator "grid"; others do not mind it
};

/// What tracing a block of image rows found. Rows count from the top of the image.
struct TracedRows {
  int first_row = 0, row_count = 0;
  std::vector<GlintQuery> queries;  ///< ordered by pixel, subpixel, light: the order in which they are summed
  std::vector<LitPoint> points;     ///< that gather light, ordered by pixel and subpixel; see LightGathering
  std::vector<LitBrdf> lit;         ///< lights on materials that are patch BRDFs, ordered as `queries`
  std::vector<Eigen::Vector3f> radiance;  ///< a pixel: diffuse lobes and background, without glints
  /// AOVs, a pixel: means over its subpixels that hit a shape; zero where none did.
  std::vector<Eigen::Vector2f>
      uv;  ///< coordinates in the map, wrapped to [0, 1); a mean across the wrap stays there
  std::vector<Eigen::Vector3f> footprint;  ///< cuu, cuv, cvv in uv^2
  std::vector<Eigen::Vector3f> normal;     ///< geometric normal towards the camera, world space
  std::vector<std::uint16_t> query_count;
};

/// What a scene hands out for the lights that are gathered by sampling directions.
struct LightGathering {
  bool points = false;                ///< trace fills TracedRows::points
  std::vector<bool> patch_materials;  ///< those whose lights go to TracedRows::lit instead of `queries`
};

/// Shapes, lights and camera, ready to be traced. Immutable after construction; traced from any number of
/// threads.
///
/// A pixel is divided evenly into subpixels, with one ray through the centre of each and a Gaussian filter of
/// standard deviation half a subpixel about it; neither is jittered. A footprint lies on the tangent plane,
/// in a frame of which x points along +u, y at right angles to it on the side of +v (also where uv is
/// mirrored) and z along the smooth geometric normal, towards the camera: a surface seen from behind shows
/// the same map.
class Scene {
 public:
  /// @param width, height image in pixels; @param subpixels footprints a pixel and axis, 1..16.
  /// @param masking_alpha Beckmann roughness of each material's Smith G [Yan14] Eq. 1, >= 0: from the slopes'
  /// variance of its map and its own roughness; 0.1 for materials that it leaves out. Throws UsageError for
  /// settings that make no sense, FileError for meshes and backgrounds that cannot be used.
  Scene(const SceneDescription& description, int width, int height, int subpixels,
        std::vector<double> masking_alpha = {}, LightGathering gathering = {});
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  /// The same shapes and background from another camera under other lights; they are shared, not built again.
  Scene with_view(const CameraDescription& camera, const std::vector<LightDescription>& lights,
                  const std::vector<double>& masking_alpha) const;

  /// Traces rows [first_row, first_row + row_count). The result depends on nothing but the scene and the
  /// rows. Throws UsageError for rows outside the image.
  TracedRows trace(int first_row, int row_count) const;

  /// What was assumed and repaired in the images of backgrounds and environments.
  const Findings& findings() const;
  const Geometry& geometry() const;
  const Environment& environment() const;
  const std::vector<LightDescription>& lights() const;
  const std::vector<MaterialDescription>& materials() const;
  std::uint32_t material_of(const Hit& hit) const;     ///< index into materials()
  double masking_alpha(std::uint32_t material) const;  ///< as it was given
  const std::optional<CoatInterface>& coat(std::uint32_t material) const;

 private:
  struct Implementation;
  explicit Scene(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace mica::host
