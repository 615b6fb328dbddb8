#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "host/base/glints.h"
#include "host/base/query.h"
#include "host/scene/description.h"
#include "host/scene/disk_cells.h"
#include "host/scene/environment.h"
#include "host/scene/geometry.h"
#include "host/scene/lattice.h"
#include "host/scene/layered_material.h"
#include "host/scene/lit_point.h"
#include "host/scene/pixel_filter.h"
#include "host/scene/smooth_material.h"

namespace mica::host {

/// One light seen in one footprint: the P-NDF to ask for, and what to multiply it with.
struct GlintQuery {
  static constexpr std::uint32_t kNone = Lattice::kNone;
  Query query;                   ///< in the map's uv (repeat applied), roughness of the material
  std::uint32_t pixel = kNone;   ///< row * width + column, from the first traced row; kNone lies outside
  std::uint32_t sample = kNone;  ///< of the lattice; kNone: all of the pixel's
  std::uint32_t material = 0;    ///< index into SceneDescription::materials
  std::uint32_t light = 0;       ///< index into Scene::lights
  Eigen::Vector3f weight = Eigen::Vector3f::Zero();  ///< radiance into the pixel or sample per unit of D
  GlintPoint glints;                                 ///< for the evaluator "grid"; others do not mind it
  /// Relative L2 of what the footprint stands for, and of the lamp's part as one Gaussian: over glints
  /// anywhere.
  float missed_by_footprint = 0, missed_by_lamp = 0;
  /// Of a lamp that a shadow hides from the sample: luminance per unit of D if it did not. See
  /// PixelSettings::asks_hidden.
  float hidden_weight = 0;
};

/// What a sample shows of one lamp that needs no P-NDF.
struct LampSample {
  std::uint32_t sample, light;  ///< as in GlintQuery
  Eigen::Vector3f radiance;
};

/// What tracing a block of image rows found. Rows count from the top of the image.
///
/// A pixel that was fitted has its light in `radiance` and in queries of its own; where some lamps have
/// edges, it is besides a sum over what samples show of these. All others are sums over the samples of
/// `lattice`, which have their light in `sample_radiance` and in queries of theirs.
struct TracedRows {
  int first_row = 0, row_count = 0;
  std::vector<GlintQuery>
      queries;                   ///< ordered by row, pixel, sample, light: the order in which they are summed
  std::vector<LitPoint> points;  ///< samples that gather light, in the same order; see LightGathering
  std::vector<LitBrdf> lit;      ///< lights on materials that are patch BRDFs, likewise
  Lattice lattice;
  std::vector<std::uint8_t> fitted;                       ///< a pixel: 1, or 0 where it is a sum of samples
  std::vector<Eigen::Vector3f> radiance;                  ///< a pixel: of what needs no P-NDF; of fitted ones
  std::vector<Eigen::Vector3f> sample_radiance;           ///< a sample
  std::vector<std::vector<std::uint32_t>> sampled_lamps;  ///< a pixel: of a fitted one, lights in order
  std::vector<LampSample> lamp_samples;                   ///< for these, in the order of samples
  /// AOVs, a pixel: means over its samples that hit a shape; zero where none did.
  std::vector<Eigen::Vector2f>
      uv;  ///< coordinates in the map, wrapped to [0, 1); a mean across the wrap stays there
  std::vector<Eigen::Vector3f> footprint;  ///< cuu, cuv, cvv in uv^2
  std::vector<Eigen::Vector3f> normal;     ///< geometric normal towards the camera, world space
  std::vector<std::uint16_t> query_count;
  std::vector<float> doubt;     ///< a pixel: by how much of luminance its samples may be off; see Refinement
  std::vector<float> coverage;  ///< share of shapes in it; empty where nobody asked
};

/// Adds to `radiance`, a pixel, what pixels that were not fitted see of `sample_radiance`.
void add_samples(const TracedRows& rows, const std::vector<Eigen::Vector3d>& sample_radiance,
                 std::vector<Eigen::Vector3d>* radiance);

/// How pixels see.
struct PixelSettings {
  int subpixels = 4;  ///< samples a pixel and axis, 1..16, where one footprint will not do
  PixelFilter filter = PixelFilter({});
  bool fits = false;                    ///< pixels may be fitted; else all are sums of samples
  std::vector<bool> takes_first_order;  ///< a material: queries may turn, and have lobes that are not round
  bool turns = true;                    ///< half vectors do, over samples; fits always turn them
  double tolerance = 0.01;              ///< of fits, see FitLimits::relative_l2
  LampParts lamp_parts;
  /// Samples are asked what lamps would show that a shadow hides from them, but not from one beside them in
  /// their pixel, and how much bends leave out. These queries weigh nothing: the edge of the shadow may be
  /// anywhere between a sample and those beside it, and they say what it may hide there.
  bool asks_hidden = false;
};

/// What a scene hands out for the lights that are gathered by sampling directions.
struct LightGathering {
  bool points = false;                ///< trace fills TracedRows::points
  std::vector<bool> patch_materials;  ///< those whose lights go to TracedRows::lit instead of `queries`
};

struct Viewer;

/// Shapes, lights and camera, ready to be traced. Immutable after construction; traced from any number of
/// threads.
///
/// Where a pixel and what surrounds it within the filter's reach lie on one surface and in one light, a fit
/// of second order says which footprints stand for its filter (see PixelFit). Elsewhere pixels are divided
/// evenly into subpixels, with one ray through the centre of each and a Gaussian about it; their sum is the
/// filter (see PixelFilter). Rays are not jittered. A footprint lies on the tangent plane, in a frame of
/// which x points along +u, y at right angles to it on the side of +v (also where uv is mirrored) and z along
/// the smooth geometric normal, towards the camera: a surface seen from behind shows the same map.
class Scene {
 public:
  /// @param width, height image in pixels; @param pixels by default: sums of Gaussians of half a subpixel.
  /// @param lobes each material's normals from afar: of its map and its own roughness, or of its glints;
  /// their alpha is that of Smith's G [Yan14] Eq. 1. 0.1 for materials that it leaves out. Throws UsageError
  /// for settings that make no sense, FileError for meshes and backgrounds that cannot be used.
  Scene(const SceneDescription& description, int width, int height, PixelSettings pixels,
        std::vector<SmoothLobe> lobes = {}, LightGathering gathering = {});
  Scene(const SceneDescription& description, int width, int height, int subpixels,
        std::vector<SmoothLobe> lobes = {}, LightGathering gathering = {});
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  /// The same shapes and background from another camera under other lights; they are shared, not built again.
  /// @param lobes, pixels as in the constructor: maps may have changed, too.
  Scene with_view(const CameraDescription& camera, const std::vector<LightDescription>& lights,
                  const std::vector<SmoothLobe>& lobes, PixelSettings pixels) const;

  /// Traces rows [first_row, first_row + row_count). The result depends on nothing but the scene and the
  /// rows. Throws UsageError for rows outside the image.
  TracedRows trace(int first_row, int row_count) const;

  /// Traces one pixel in another way, a row of one.
  /// @param pixels without fits; of any number of subpixels.
  TracedRows trace_pixel(int row, int column, const PixelSettings& pixels) const;

  /// Takes samples of rows; their pixels stay black. A sample does not depend on which others are taken.
  /// @param chosen by the cells of the lattice of `pixels`.
  /// @param pixels without fits; of any number of subpixels.
  TracedRows sample(int first_row, int row_count, const Lattice::Choice& chosen,
                    const PixelSettings& pixels) const;
  /// The lattice of rows of the image, without samples.
  Lattice lattice(const PixelSettings& pixels) const;

  const Viewer& viewer() const;
  const PixelSettings& pixels() const;
  /// What was assumed and repaired in the images of backgrounds and environments.
  const Findings& findings() const;
  const Geometry& geometry() const;
  const Environment& environment() const;
  const std::vector<LightDescription>& lights() const;
  const std::vector<MaterialDescription>& materials() const;
  std::uint32_t material_of(const Hit& hit) const;  ///< index into materials()
  const LayeredMaterial& layers(std::uint32_t material) const;
  SmoothNormals normals_from_afar(std::uint32_t material, const Hit& hit) const;

 private:
  struct Implementation;
  explicit Scene(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace mica::host
