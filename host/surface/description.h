#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "host/base/words.h"
#include "host/image/picture.h"

namespace mica::host {

enum class Interpolation { nearest, bilinear, bicubic };
enum class Encoding { unorm, signed_float, height, slope };  ///< `signed` is a keyword: signed_float
enum class GreenDirection { up, down };

template <>
struct Words<Interpolation> {
  static constexpr Word<Interpolation> all[] = {{"nearest", Interpolation::nearest},
                                                {"bilinear", Interpolation::bilinear},
                                                {"bicubic", Interpolation::bicubic}};
};

template <>
struct Words<Encoding> {
  static constexpr Word<Encoding> all[] = {{"unorm", Encoding::unorm},
                                           {"signed", Encoding::signed_float},
                                           {"height", Encoding::height},
                                           {"slope", Encoding::slope}};
};

template <>
struct Words<GreenDirection> {
  static constexpr Word<GreenDirection> all[] = {{"up", GreenDirection::up}, {"down", GreenDirection::down}};
};

/// What becomes of a file's steps, where they are coarse beside a roughness: normals stay as they are, are
/// restored between the steps where their neighbours tell, or lobes are wider by the variance of rounding.
enum class Precision { as_is, restore, widen };

template <>
struct Words<Precision> {
  static constexpr Word<Precision> all[] = {
      {"as-is", Precision::as_is}, {"restore", Precision::restore}, {"widen", Precision::widen}};
};

/// A normal map in a file. Settings that the job leaves out are derived from the pixel type and logged.
struct MapFile {
  std::string path;
  PictureChoice choice = {};
  bool encoding_given = false;  ///< false: told by the pixels, and logged
  Encoding encoding = Encoding::unorm;
  GreenDirection green = GreenDirection::up;
  TexelRepair invalid = TexelRepair::refuse;
  double height_scale = 1.0;  ///< `height` only: texels of height per unit of the image's value
  Precision precision = Precision::as_is;
};

/// Heightfield by inverse FFT of a Gaussian power spectrum with random phase ([Yan14] snail).
struct SpectrumSurface {
  int resolution = 2048;            ///< texels a side, 4..16384; fastest when its prime factors are small
  double rms_slope = 0.15;          ///< sqrt(E[p^2 + q^2]) of the slopes p, q; 0..5
  double correlation_texels = 8.0;  ///< distance at which the height's autocorrelation is 1/e
  std::uint64_t seed = 1;
};

/// Metallic flakes: Voronoi cells of Poisson-disk centres, each with one Beckmann-distributed normal
/// ([Yan14] paint).
struct FlakesSurface {
  int resolution = 2048;            ///< texels a side, 8..16384
  double flake_size_texels = 12.0;  ///< mean distance between neighbouring centres, 2..resolution / 4
  double alpha = 0.2;               ///< Beckmann roughness of the flakes' normals, 0..2
  std::uint64_t seed = 1;
};

/// Brushed metal: a Gaussian heightfield like SpectrumSurface, stretched along the brushing ([Yan14]
/// blender).
struct BrushedSurface {
  int resolution = 2048;                  ///< texels a side, 4..16384
  double rms_slope = 0.15;                ///< sqrt(E[p^2 + q^2]) of the slopes p, q; 0..5
  double correlation_along_texels = 200;  ///< where the height's autocorrelation is 1/e, along the brushing
  double correlation_across_texels = 3;   ///< and across it
  double direction_degrees = 0;           ///< direction of the brushing, from +u towards +v; -360..360
  std::uint64_t seed = 1;
};

enum class ScratchProfile { v, rounded };

template <>
struct Words<ScratchProfile> {
  static constexpr Word<ScratchProfile> all[] = {{"v", ScratchProfile::v},
                                                 {"rounded", ScratchProfile::rounded}};
};

/// Random scratches in a flat surface, straight or slightly bent ([Yan14] cutlery). Heights add where they
/// cross.
struct ScratchesSurface {
  int resolution = 2048;       ///< texels a side, 4..16384
  double density = 0.3;        ///< sum of length times width over the map's area, 0..4
  double length_texels = 400;  ///< mean, 2..resolution
  double width_texels = 8;     ///< mean, 1..length
  double depth_texels = 0.6;   ///< mean of the deepest point, 0..width
  double variation = 0.5;      ///< length, width and depth vary, each for itself, by up to this share; 0..0.9
  double direction_degrees = 0;  ///< mean, from +u towards +v; -360..360
  double spread_degrees = 90;    ///< directions are uniform up to this far from the mean; 0..90
  double bend = 0;               ///< up to this far from the chord, over the length; 0..0.2
  ScratchProfile profile = ScratchProfile::rounded;
  std::uint64_t seed = 1;
};

/// Smooth round dents at random places. Heights add where they overlap.
struct DentsSurface {
  int resolution = 2048;           ///< texels a side, 4..16384
  double density = 0.5;            ///< sum of the dents' areas over the map's, 0..16
  double radius_low_texels = 8;    ///< radii are uniform from here, 1..resolution
  double radius_high_texels = 32;  ///< to here, at most the resolution
  double depth = 0.1;              ///< depth of a dent, over its radius; 0..1
  std::uint64_t seed = 1;
};

/// Bumpy plastic: caps of ellipsoids on a jittered lattice ([Yan14] blender). Heights add where they overlap.
struct BumpsSurface {
  int resolution = 2048;  ///< texels a side, 4..16384
  double cell_texels =
      24;               ///< side of the lattice's cells, 4..resolution; rounded so that they fill the period
  double size = 0.8;    ///< length of a bump over the cell's side, above 0..2
  double aspect = 1.5;  ///< length of a bump over its width, 1..10; each is turned at random
  double slope = 0.3;   ///< the steepest of a bump, at its rim; 0..5
  double jitter = 0.5;  ///< centres are uniform over this share of their cell's sides; 0..1
  std::uint64_t seed = 1;
};

/// Wind sea in deep water, at one moment ([Yan14] ocean).
struct WavesSurface {
  int resolution = 2048;              ///< texels a side, 4..16384
  double patch_meters = 250;          ///< side of one map period, above 0..1e6
  double wind_speed = 8;              ///< metres a second, 19.5 m above the sea; above 0..100
  double wind_direction_degrees = 0;  ///< that the waves run in, from +u towards +v; -360..360
  double time_seconds = 0;            ///< at frame 0; -1e6..1e6
  double time_scale = 1;              ///< seconds of the sea by second of the frames; 0..1e3
  std::uint64_t seed = 1;
};

struct SurfaceLayer;

/// Sum of other surfaces' slopes, texel by texel.
struct LayersSurface {
  std::vector<SurfaceLayer> layers;  ///< one or more, of one size
};

/// `[surface.NAME]` of a job: where its normals come from, and how they are interpolated.
struct SurfaceDescription {
  std::string name;
  std::variant<MapFile, SpectrumSurface, FlakesSurface, BrushedSurface, ScratchesSurface, DentsSurface,
               BumpsSurface, WavesSurface, LayersSurface>
      source;
  Interpolation interpolation = Interpolation::bilinear;  ///< flakes default to nearest
};

struct SurfaceLayer {
  SurfaceDescription surface;  ///< its interpolation is of no effect
  double weight = 1;           ///< that its slopes are multiplied by, -100..100
};

}  // namespace mica::host
