#include "host/surface/map_precision.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/random.h"
#include "host/surface/disk.h"
#include "host/surface/restore_steps.h"

namespace mica::host {
namespace {

constexpr int kIterations = 200, kTileIterations = 80;
constexpr double kSigmaTexels = 24, kFootprintReach = 3;  // of footprints; standard deviations
constexpr int kMargin = 32;                               // of a tile, whose edges are no neighbours
constexpr int kFlatTexels = 400;                          // of a facet that is wider than plateaus of a slope
constexpr std::size_t kTiles = 4;
constexpr float kHalfStep = 0.51f;  // of one that scaling to length 1 moved, too

/// A square of the surface, in steps; one grid a coordinate.
struct Tile {
  int side = 0;
  std::array<RoundedGrid, 2> grids;

  Tile(const Surface& surface, long first_i, long first_j, int texels) : side(texels) {
    for (RoundedGrid& grid : grids) grid.width = grid.height = side;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const Eigen::Vector2d steps = surface.texel(first_i + i, first_j + j) / surface.step();
        for (const int axis : {0, 1}) grids[axis].values.push_back(static_cast<float>(steps[axis]));
      }
  }
  Eigen::Vector2f at(int i, int j) const {
    const std::size_t n = static_cast<std::size_t>(j) * side + i;
    return {grids[0].values[n], grids[1].values[n]};
  }
};

/// Numbers of the facets that texels lie on: neighbours that are equal, up to what scaling to length 1 moves
/// them by.
std::vector<int> facets_of(const Tile& tile) {
  constexpr float same = 0.2f;
  std::vector<int> facets(static_cast<std::size_t>(tile.side) * tile.side, -1), open;
  int count = 0;
  for (int start = 0; start < tile.side * tile.side; ++start) {
    if (facets[start] >= 0) continue;
    open.assign(1, start);
    facets[start] = count;
    while (!open.empty()) {
      const int n = open.back(), i = n % tile.side, j = n / tile.side;
      open.pop_back();
      for (const auto& [x, y] : {std::pair{i + 1, j}, {i - 1, j}, {i, j + 1}, {i, j - 1}}) {
        if (x < 0 || y < 0 || x >= tile.side || y >= tile.side) continue;
        const int m = y * tile.side + x;
        if (facets[m] >= 0 || (tile.at(i, j) - tile.at(x, y)).cwiseAbs().maxCoeff() > same) continue;
        facets[m] = count;
        open.push_back(m);
      }
    }
    ++count;
  }
  return facets;
}

/// Another surface that rounds to the tile.
Tile another(const Tile& tile, std::uint64_t seed) {
  Tile other = tile;
  const std::vector<int> facets = facets_of(tile);
  std::vector<int> texels_of(facets.size());
  for (const int facet : facets) ++texels_of[facet];
  const SmoothShares shares = smooth_shares(tile.grids[0], tile.grids[1], 1);
  restore_steps(kTileIterations, &other.grids[0], &other.grids[1]);
  for (const int axis : {0, 1}) {
    for (std::size_t n = 0; n < facets.size(); ++n) {
      const float rounded = tile.grids[axis].values[n];
      // Nothing tells where between the steps a wide facet lies, but that what may be flat is.
      const bool is_wide = texels_of[facets[n]] >= kFlatTexels;
      const float smooth =
          is_wide ? 0.0f : std::max({shares[0][n], shares[1][n], shares[2][n], shares[3][n]});
      const double within = random_unit(seed, static_cast<std::uint64_t>(axis), facets[n]) - 0.5;
      const bool is_flat = is_wide && std::abs(rounded) <= kHalfStep;
      const float apart = is_flat ? 0.0f : rounded + static_cast<float>(within);
      float& value = other.grids[axis].values[n];
      value = smooth * value + (1 - smooth) * apart;
    }
  }
  return other;
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
  std::array<RoundedGrid, 2> grids;
  for (const int axis : {0, 1}) {
    grids[axis] = {width, height, std::vector<float>(normals->size())};
    for (std::size_t n = 0; n < normals->size(); ++n)
      grids[axis].values[n] = static_cast<float>((*normals)[n][axis] / step);
  }
  restore_steps(kIterations, &grids[0], &grids[1]);
  for (const int axis : {0, 1})
    for (std::size_t n = 0; n < normals->size(); ++n) (*normals)[n][axis] = step * grids[axis].values[n];
  for (Eigen::Vector2d& normal : *normals)
    if (normal.norm() > kRim) normal *= kRim / normal.norm();
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
    const Tile tile(surface, place(0, surface.width()), place(1, surface.height()), side);
    const Tile other = another(tile, n);
    Eigen::Vector2f low = tile.at(0, 0), high = low;
    for (int k = 0; k < side * side; ++k) {
      low = low.cwiseMin(tile.at(k % side, k / side));
      high = high.cwiseMax(tile.at(k % side, k / side));
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
