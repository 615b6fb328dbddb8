#pragma once

#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/surface/disk.h"
#include "host/surface/extent.h"

/// Surfaces of many small features (scratches, dents, bumps) in a plane, around the torus.
namespace mica::host::synthesis {

/// Bands of neighbouring rows, and which features reach into each: what one task draws.
class RowBands {
 public:
  static constexpr int kRows = 32;

  explicit RowBands(int resolution) : resolution_(resolution), features_((resolution + kRows - 1) / kRows) {}

  /// Features have to be added in order of index.
  void add(std::uint32_t feature, const TexelRange& rows);

  int count() const { return static_cast<int>(features_.size()); }
  const std::vector<std::uint32_t>& features(int band) const { return features_[band]; }

 private:
  int resolution_;
  std::vector<std::vector<std::uint32_t>> features_;
};

/// `index` around the period.
inline int wrapped(long index, int period) {
  const long remainder = index % period;
  return static_cast<int>(remainder < 0 ? remainder + period : remainder);
}

/// Normals of the sum of the features' heights, which are 0 outside their extents.
///
/// Every texel adds up the features in order of index, so the result has the same bits for any number of
/// threads.
/// @param features with center_texels, extent() and slope(offset in texels).
/// @return resolution^2 normals on the disk, row v near 0 first.
template <typename Feature>
std::vector<Eigen::Vector2d> normals_of_features(int resolution, const std::vector<Feature>& features) {
  RowBands bands(resolution);
  for (std::size_t n = 0; n < features.size(); ++n)
    bands.add(static_cast<std::uint32_t>(n), features[n].extent().rows(features[n].center_texels.y()));

  std::vector<Eigen::Vector2d> texels(static_cast<std::size_t>(resolution) * resolution,
                                      Eigen::Vector2d::Zero());
  const auto draw = [&](const Feature& feature, int band) {
    const Eigen::Vector2d center = feature.center_texels;
    const Extent extent = feature.extent();
    const TexelRange rows = extent.rows(center.y());
    for (long j = rows.first; j <= rows.last; ++j) {
      const int row = wrapped(j, resolution);
      if (row / RowBands::kRows != band) continue;
      const double v = static_cast<double>(j) + 0.5 - center.y();
      const TexelRange columns = extent.columns(center.x(), v);
      for (long i = columns.first; i <= columns.last; ++i) {
        const double u = static_cast<double>(i) + 0.5 - center.x();
        texels[static_cast<std::size_t>(row) * resolution + wrapped(i, resolution)] += feature.slope({u, v});
      }
    }
  };
  tbb::parallel_for(0, bands.count(), [&](int band) {
    for (const std::uint32_t feature : bands.features(band)) draw(features[feature], band);
  });
  tbb::parallel_for(std::size_t{0}, texels.size(),
                    [&](std::size_t texel) { texels[texel] = disk_from_slope(texels[texel]); });
  return texels;
}

}  // namespace mica::host::synthesis
