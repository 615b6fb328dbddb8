#pragma once

#include "host/base/query.h"
#include "host/methods/cavities/compensation.h"
#include "host/surface/description.h"
#include "kernels/types.h"

namespace mica::host {

/// What the queries of one map of cavities have in common.
struct CavityGrid {
  device_types::mica_map_grid grid{};
  Interpolation interpolation = Interpolation::bilinear;
  int per_texel = 1;                         ///< seeds a texel and axis
  double compensation_width = kMirrorWidth;  ///< of the specular compensation, in roughnesses
};

/// How the weights of the seeds fall off about a footprint. [Che19] Eq. 17, divided by their sum.
struct SeedWeights {
  Footprint footprint;         ///< with the position kernel's variance
  Eigen::Vector2d mean_seeds;  ///< of the footprint, in spacings from seed (0, 0)
  Eigen::Matrix2d cov_seeds;   ///< in spacings^2
  double sum = 1;              ///< of all weights
};
SeedWeights seed_weights(const Footprint& footprint, const CavityGrid& cavities);

/// f_1(o, i) max(i.g, 0) over the density of facets on the disk at the half vector and at its opposite.
/// [Che19] Eq. 7 for mirrors. 0 below the horizon.
double facet_reflection(const Eigen::Vector3d& view, const Eigen::Vector3d& light);

/// The query of kernels/cavities/cavities.cl: answers f_1(o, i) max(i.g, 0).
/// @param cutoff largest sum of squared distances that counts, see `cutoff_for`.
device_types::mica_map_query to_cavity_query(const BrdfQuery& query, const CavityGrid& cavities,
                                             double cutoff);

/// The query of kernels/cavities/cavity_energies.cl and cavity_draws.cl, without a seed and a key.
device_types::mica_cavity_query to_cavity_query(const ViewQuery& query, const CavityGrid& cavities,
                                                double cutoff);

/// The query of kernels/cavities/cavity_samples.cl: cells of one seed each, all of them, up to twelve of them
/// in a standard deviation of the footprint; wider ones have more than one seed.
device_types::mica_sampled_cavity_query to_sampled_query(const ViewQuery& query, const CavityGrid& cavities,
                                                         double cutoff);

}  // namespace mica::host
