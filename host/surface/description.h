#pragma once

#include <cstdint>
#include <string>
#include <variant>

namespace mica {

enum class Interpolation { nearest, bilinear, bicubic };
enum class Encoding { unorm, signed_float, height, slope };  ///< `signed` is a keyword: signed_float
enum class GreenDirection { up, down };
enum class TexelRepair { repair, refuse };  ///< what to do with NaN, infinite and zero-length texels

/// A normal map in a file. Settings that the job leaves out are derived from the pixel type and logged.
struct MapFile {
  std::string path;
  bool encoding_given = false;  ///< false: unorm for unsigned pixels, signed_float for others, and logged
  Encoding encoding = Encoding::unorm;
  GreenDirection green = GreenDirection::up;
  TexelRepair invalid = TexelRepair::refuse;
  double height_scale = 1.0;  ///< `height` only: texels of height per unit of the image's value
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

/// `[surface.NAME]` of a job: where its normals come from, and how they are interpolated.
struct SurfaceDescription {
  std::string name;
  std::variant<MapFile, SpectrumSurface, FlakesSurface> source;
  Interpolation interpolation = Interpolation::bilinear;  ///< flakes default to nearest
};

}  // namespace mica
