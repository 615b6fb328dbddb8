#include "host/surface/map_precision.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/interrupt.h"
#include "host/base/random.h"
#include "host/surface/between_steps.h"
#include "host/surface/disk.h"
#include "host/surface/facets.h"
#include "host/surface/features.h"
#include "host/surface/tile_density.h"

namespace mica::host {
namespace {

constexpr double kSigmaTexels = 24, kFootprintReach = 2.5;  // of footprints; standard deviations
constexpr int kMargin = 35;                                 // of a tile, whose edges are no neighbours
constexpr std::size_t kTiles = 4;
constexpr int kHalfVectors = 128, kFewestHalfVectors = 8, kMostLookedAt = 400'000;  // of a tile
constexpr int kDrawsOfError = 3, kDrawsOfMean = 10;
constexpr int kSmoothingOfError = 40, kSmoothingOfMean = 160;  // iterations
constexpr int kRestored = 256, kRestoredMargin = 64;           // texels a side that are restored at a time

/// A square of the surface, in steps.
struct Tile {
  int side = 0;
  PairGrid normals;

  /// @param texel (i, j), in steps. @param texels at least a side; there may be more, to the right and above.
  template <typename Texel>
  Tile(long first_i, long first_j, int texels, const Texel& texel)
      : side((texels + LocalFilter::kHop - 1) / LocalFilter::kHop * LocalFilter::kHop) {
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const Eigen::Vector2d steps = texel(first_i + i, first_j + j);
        normals.emplace_back(static_cast<float>(steps.x()), static_cast<float>(steps.y()));
      }
  }
};

/// Whether steps are lost in what texels differ by: then nothing is known between them.
bool is_rough(const Tile& tile) {
  constexpr float few_steps = 4;
  constexpr double hardly_any = 0.004;
  const auto is_near = [](float a, float b) { return std::abs(a - b) < few_steps; };
  int near = 0;
  for (std::size_t n = 0; n + tile.side < tile.normals.size(); ++n)
    for (const std::size_t other : {n + 1, n + tile.side}) {
      const std::complex<float>&a = tile.normals[n], &b = tile.normals[other];
      near += is_near(a.real(), b.real()) || is_near(a.imag(), b.imag());
    }
  return near < hardly_any * 2 * static_cast<double>(tile.normals.size());
}

/// Another surface that rounds to the tile.
Tile another(const Tile& tile, std::uint64_t seed) {
  Tile other = tile;
  other.normals = is_rough(tile)
                      ? anywhere_between_steps(tile.normals, seed)
                      : between_steps(tile.side, tile.normals, kDrawsOfError, kSmoothingOfError, seed).draw;
  const Facets facets = find_facets(tile.side, tile.normals);
  for (std::size_t n = 0; n < facets.of_texel.size(); ++n) {
    const int facet = facets.of_texel[n];
    const auto within = [&](std::uint64_t axis) {
      return static_cast<float>(random_unit(seed + kTiles, axis, facet) - 0.5);
    };
    if (facets.is_plane[facet])
      other.normals[n] = 0;
    else if (facets.is_cut_out[facet])
      other.normals[n] = tile.normals[n] + std::complex<float>(within(0), within(1));
  }
  return other;
}

/// The third coordinate's rounding is in a normal's length, which it was divided by: a change from plateau to
/// plateau, that no sum over texels evens out.
void undo_scaling(double step, double third_step, Tile* tile) {
  for (std::complex<float>& normal : tile->normals) {
    const double square = step * step * std::norm(normal), z = std::sqrt(std::max(1 - square, 0.0)),
                 rounded_z = std::round((z + 1) / third_step) * third_step - 1;
    normal *= static_cast<float>(std::sqrt(square + rounded_z * rounded_z));
  }
}

/// Puts normals between half floats about the tile's, in place of steps that are equal.
void shrink_to_half_floats(const Tile& tile, double step, Tile* other) {
  const auto shrunk = [&](float rounded, float found) {
    return rounded + static_cast<float>(half_float_step(rounded * step) / step) * (found - rounded);
  };
  for (std::size_t n = 0; n < other->normals.size(); ++n) {
    const std::complex<float>&rounded = tile.normals[n], &found = other->normals[n];
    other->normals[n] = {shrunk(rounded.real(), found.real()), shrunk(rounded.imag(), found.imag())};
  }
}

/// The best guess of a tile's normals.
PairGrid restored(const Tile& tile, std::uint64_t seed) {
  PairGrid normals = between_steps(tile.side, tile.normals, kDrawsOfMean, kSmoothingOfMean, seed).mean;
  const Facets facets = find_facets(tile.side, tile.normals);
  for (std::size_t n = 0; n < normals.size(); ++n) {
    const int facet = facets.of_texel[n];
    if (facets.is_plane[facet])
      normals[n] = 0;
    else if (facets.is_cut_out[facet])
      normals[n] = tile.normals[n];
  }
  return normals;
}

/// Sums over half vectors drawn from the mean of two densities a and b: of (a - b)^2 and of b^2, each over
/// that mean. Fewer where each sees much of the map: there densities vary less.
struct SquaredSums {
  double difference = 0, square = 0;

  SquaredSums(const TileDensity& first, const TileDensity& second, std::uint64_t seed) {
    int looked_at = 0;
    for (int n = 0; n < kHalfVectors && (n < kFewestHalfVectors || looked_at < kMostLookedAt); ++n) {
      const Eigen::Vector2f half_vector = (n % 2 == 0 ? first : second).draw(seed, n);
      const double a = first.at(half_vector, &looked_at), b = second.at(half_vector, &looked_at),
                   mean = 0.5 * (a + b);
      if (mean > 0) difference += (a - b) * (a - b) / mean, square += b * b / mean;
    }
  }
};

}  // namespace

double half_float_step(double number) {
  constexpr int mantissa_bits = 10, least_exponent = -14;
  const int exponent = number != 0 ? std::max(std::ilogb(number), least_exponent) : least_exponent;
  return std::exp2(exponent - mantissa_bits);
}

void restore_normals(int width, int height, double step, std::vector<Eigen::Vector2d>* normals) {
  const std::vector<Eigen::Vector2d> rounded = *normals;
  const auto texel = [&](long i, long j) -> Eigen::Vector2d {
    return rounded[static_cast<std::size_t>(synthesis::wrapped(j, height)) * width +
                   synthesis::wrapped(i, width)] /
           step;
  };
  const int columns = (width + kRestored - 1) / kRestored, rows = (height + kRestored - 1) / kRestored;
  tbb::parallel_for(0, columns * rows, [&](int n) {
    const int first_i = n % columns * kRestored, first_j = n / columns * kRestored;
    const int most_i = std::min(kRestored, width - first_i), most_j = std::min(kRestored, height - first_j);
    check_interrupt();
    const Tile tile(first_i - kRestoredMargin, first_j - kRestoredMargin,
                    std::max(most_i, most_j) + 2 * kRestoredMargin, texel);
    const PairGrid found = restored(tile, n);
    for (int j = 0; j < most_j; ++j)
      for (int i = 0; i < most_i; ++i) {
        const std::complex<float>& steps =
            found[static_cast<std::size_t>(j + kRestoredMargin) * tile.side + i + kRestoredMargin];
        Eigen::Vector2d& normal = (*normals)[static_cast<std::size_t>(first_j + j) * width + first_i + i];
        normal = step * Eigen::Vector2d(steps.real(), steps.imag());
        if (normal.norm() > kRim) normal *= kRim / normal.norm();
      }
  });
}

double precision_error(const Surface& surface, double roughness) {
  if (!(surface.step() > 0)) return 0;
  const double sigma = std::min(kSigmaTexels, 0.25 * std::min(surface.width(), surface.height())),
               roughness_steps = roughness / surface.step();
  const int side = 2 * (static_cast<int>(std::ceil(kFootprintReach * sigma)) + kMargin) + 1;
  std::array<double, kTiles> differences{}, squares{};
  tbb::parallel_for(std::size_t{0}, kTiles, [&](std::size_t n) {
    const auto place = [&](std::uint64_t stream, int size) {
      return static_cast<long>(random_unit(13, stream, n) * size);
    };
    const Tile tile(place(0, surface.width()), place(1, surface.height()), side,
                    [&](long i, long j) -> Eigen::Vector2d { return surface.texel(i, j) / surface.step(); });
    Tile other = another(tile, n);
    if (surface.has_half_floats()) shrink_to_half_floats(tile, surface.step(), &other);
    if (surface.third_step() > 0) undo_scaling(surface.step(), surface.third_step(), &other);
    const auto density = [&](const Tile& of) {
      return TileDensity(of.side, of.normals, surface.interpolation(), kMargin, sigma, roughness_steps);
    };
    const SquaredSums sums(density(tile), density(other), kTiles + n);
    differences[n] = sums.difference, squares[n] = sums.square;
  });
  double difference = 0, square = 0;
  for (std::size_t n = 0; n < kTiles; ++n) difference += differences[n], square += squares[n];
  return std::sqrt(difference / square);
}

double report_precision(const Surface& surface, double roughness, Findings* findings) {
  constexpr double worth_a_word = 1e-3, worth_a_warning = 0.05;
  const double error = precision_error(surface, roughness);
  if (!(error >= worth_a_word)) return error;
  const std::string text = fmt::format(
      "its steps of {:.2g} put P-NDFs off by about {:.2g}% (relative L2 at roughness {:.3g} under "
      "footprints of {:g} texels); see precision",
      surface.step(), 100 * error, roughness, kSigmaTexels);
  (error < worth_a_warning ? findings->notes : findings->warnings).push_back(text);
  return error;
}

}  // namespace mica::host
