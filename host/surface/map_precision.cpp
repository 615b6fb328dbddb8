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

namespace mica::host {
namespace {

constexpr double kSigmaTexels = 24, kFootprintReach = 2.5;  // of footprints; standard deviations
constexpr int kMargin = 35;                                 // of a tile, whose edges are no neighbours
constexpr std::size_t kTiles = 3;
constexpr int kDrawsOfError = 3, kDrawsOfMean = 10;
constexpr int kRestored = 256, kRestoredMargin = 64;  // texels a side that are restored at a time

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
  Eigen::Vector2f at(int i, int j) const {
    const std::complex<float>& normal = normals[static_cast<std::size_t>(j) * side + i];
    return {normal.real(), normal.imag()};
  }
};

/// Another surface that rounds to the tile.
Tile another(const Tile& tile, std::uint64_t seed) {
  Tile other = tile;
  other.normals = between_steps(tile.side, tile.normals, kDrawsOfError, seed).draw;
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
void undo_scaling(double step, Tile* tile) {
  for (std::complex<float>& normal : tile->normals) {
    const double square = step * step * std::norm(normal), z = std::sqrt(std::max(1 - square, 0.0)),
                 rounded_z = std::round((z + 1) / step) * step - 1;
    normal *= static_cast<float>(std::sqrt(square + rounded_z * rounded_z));
  }
}

/// The best guess of a tile's normals.
PairGrid restored(const Tile& tile, std::uint64_t seed) {
  PairGrid normals = between_steps(tile.side, tile.normals, kDrawsOfMean, seed).mean;
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

/// A P-NDF as a picture over the normals under a footprint, blurred by the roughness.
class NormalPicture {
 public:
  /// @param low, high of normals, in steps. @param sigma of the roughness.
  NormalPicture(const Eigen::Vector2f& low, const Eigen::Vector2f& high, double sigma)
      : low_(low.array() - static_cast<float>(4 * sigma)),
        bin_(std::max(sigma / 3, (high - low).maxCoeff() / 768.0)),
        sigma_bins_(std::sqrt(std::max(sigma * sigma / (bin_ * bin_) - 1.0 / 6, 0.05))) {
    const Eigen::Vector2f size = high - low;
    for (const int axis : {0, 1}) counts_[axis] = static_cast<int>((size[axis] + 8 * sigma) / bin_) + 3;
    bins_.assign(static_cast<std::size_t>(counts_[0]) * counts_[1], 0.0);
  }

  void add(const Eigen::Vector2f& normal, double weight) {
    const Eigen::Array2d place = ((normal - low_).cast<double>() / bin_).array().max(0.0);
    const int x = std::min(static_cast<int>(place.x()), counts_[0] - 2),
              y = std::min(static_cast<int>(place.y()), counts_[1] - 2);
    const double f = place.x() - x, g = place.y() - y;
    double* bin = &bins_[static_cast<std::size_t>(y) * counts_[0] + x];
    bin[0] += weight * (1 - f) * (1 - g), bin[1] += weight * f * (1 - g);
    bin[counts_[0]] += weight * (1 - f) * g, bin[counts_[0] + 1] += weight * f * g;
  }

  void blur() {
    const int reach = static_cast<int>(std::ceil(4 * sigma_bins_));
    std::vector<double> taps;
    for (int n = -reach; n <= reach; ++n)
      taps.push_back(std::exp(-0.5 * n * n / (sigma_bins_ * sigma_bins_)));
    for (const int axis : {0, 1}) {
      std::vector<double> blurred(bins_.size(), 0.0);
      const std::ptrdiff_t stride = axis == 0 ? 1 : counts_[0];
      for (int y = 0; y < counts_[1]; ++y)
        for (int x = 0; x < counts_[0]; ++x) {
          const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(y) * counts_[0] + x;
          const double value = bins_[static_cast<std::size_t>(place)];
          if (value == 0) continue;
          const int n = axis == 0 ? x : y;
          for (int tap = std::max(-reach, -n); tap <= std::min(reach, counts_[axis] - 1 - n); ++tap)
            blurred[static_cast<std::size_t>(place + tap * stride)] += value * taps[tap + reach];
        }
      bins_ = std::move(blurred);
    }
  }
  const std::vector<double>& bins() const { return bins_; }

 private:
  Eigen::Vector2f low_;
  double bin_, sigma_bins_;
  int counts_[2] = {0, 0};
  std::vector<double> bins_;
};

/// Adds the interpolated normals under a Gaussian footprint in the tile's middle.
void add_footprint(const Tile& tile, Interpolation interpolation, double sigma, double roughness_steps,
                   NormalPicture* picture) {
  const double middle = 0.5 * tile.side;
  for (int j = kMargin; j + kMargin < tile.side; ++j) {
    for (int i = kMargin; i + kMargin < tile.side; ++i) {
      const Eigen::Vector2f corner = tile.at(i, j), right = tile.at(i + 1, j), up = tile.at(i, j + 1),
                            far = tile.at(i + 1, j + 1);
      const double change = std::max({(right - corner).norm(), (up - corner).norm(), (far - corner).norm()});
      const bool is_flat = interpolation == Interpolation::nearest;
      const int parts =
          is_flat ? 1 : static_cast<int>(std::clamp(2 * change / roughness_steps + 1, 2.0, 6.0));
      for (int b = 0; b < parts; ++b) {
        for (int a = 0; a < parts; ++a) {
          const float x = (static_cast<float>(a) + 0.5f) / static_cast<float>(parts),
                      y = (static_cast<float>(b) + 0.5f) / static_cast<float>(parts);
          const double dx = i + x - middle, dy = j + y - middle;
          const double weight = std::exp(-0.5 * (dx * dx + dy * dy) / (sigma * sigma)) / (parts * parts);
          // The two triangles of a quad, split from (i + 1, j) to (i, j + 1).
          const Eigen::Vector2f normal =
              is_flat     ? corner
              : x + y < 1 ? Eigen::Vector2f(corner + x * (right - corner) + y * (up - corner))
                          : Eigen::Vector2f(far + (1 - x) * (up - far) + (1 - y) * (right - far));
          picture->add(normal, weight);
        }
      }
    }
  }
}

}  // namespace

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
    if (surface.scaled()) undo_scaling(surface.step(), &other);
    Eigen::Vector2f low = tile.at(0, 0), high = low;
    for (int k = 0; k < tile.side * tile.side; ++k) {
      low = low.cwiseMin(tile.at(k % tile.side, k / tile.side));
      high = high.cwiseMax(tile.at(k % tile.side, k / tile.side));
    }
    low.array() -= 1, high.array() += 1;
    std::array<NormalPicture, 2> pictures = {NormalPicture(low, high, roughness_steps),
                                             NormalPicture(low, high, roughness_steps)};
    add_footprint(tile, surface.interpolation(), sigma, roughness_steps, &pictures[0]);
    add_footprint(other, surface.interpolation(), sigma, roughness_steps, &pictures[1]);
    for (NormalPicture& picture : pictures) picture.blur();
    for (std::size_t k = 0; k < pictures[0].bins().size(); ++k) {
      const double a = pictures[0].bins()[k], b = pictures[1].bins()[k];
      differences[n] += (a - b) * (a - b), squares[n] += b * b;
    }
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
