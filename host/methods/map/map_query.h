#pragma once

#include <string>

#include "host/base/query.h"
#include "host/surface/description.h"
#include "kernels/types.h"

namespace mica::host {

/// Why a query cannot be evaluated ("covariance is not positive definite"), or empty when it can. Evaluators
/// on maps take roughness 1e-5 to 1, standard deviations from 1e-3 to 1e6 texels, half vectors in
/// [-1, 1]^2 and any finite uv. Off the unit disk D is the density of what the roughness pushes off it
/// ([Yan14] sec. 3, the symbol \perp): over the whole plane it integrates to one.
std::string query_problem(const Query& query, int map_width, int map_height);

/// Axes of a footprint in texel space.
struct FootprintAxes {
  Eigen::Vector2d major, minor;  ///< unit vectors
  double sigma_major_texels = 0, sigma_minor_texels = 0;
};
FootprintAxes footprint_axes(const Footprint& footprint, int map_width, int map_height);

/// Whole texels in [0, size) and the rest in [0, 1) of a texture coordinate less `shift` texels.
void wrap_texel(double coordinate, int size, double shift, std::int32_t* whole, float* rest);

/// On a periodic map a footprint far wider than a period is a uniform one, and so is one of 0.8 periods,
/// which replaces it.
Footprint without_needless_periods(const Footprint& footprint);

/// What the weights of a mixture's elements under a footprint sum to, by Poisson's summation of
/// sum_n h^2 N(h (n + 1/2) - rest; cov): 1 where the covariance is wide, 6% an axis off where it is the
/// position kernel's.
/// @param cov_spacings of the weights, in spacings^2. @param mean_spacings of the footprint.
double sum_of_weights(const Eigen::Matrix2d& cov_spacings, const Eigen::Vector2d& mean_spacings);

/// The query in the kernels' form. uv is wrapped in double precision, so 1e7 periods away nothing is lost but
/// what the uv itself cannot hold.
/// @param cutoff largest sum of both Gaussians' squared distances that counts, see `cutoff_for`.
device_types::mica_map_query to_map_query(const Query& query, const device_types::mica_map_grid& grid,
                                          Interpolation interpolation, double cutoff);

/// The same where the footprint `without_needless_periods` and its axes are known.
device_types::mica_map_query to_map_query(const Query& query, const Footprint& footprint,
                                          const FootprintAxes& axes, const device_types::mica_map_grid& grid,
                                          Interpolation interpolation, double cutoff);

/// The same for triangles, which need no footprint to go by where it is many periods wide: those of one
/// period count once.
device_types::mica_map_query to_triangle_query(const Query& query, const device_types::mica_map_grid& grid,
                                               Interpolation interpolation, double cutoff);

/// The query of a mixture whose elements lie `1 / elements` texels apart. The weights of the elements under
/// the footprint are normalised: they sum to one, as those of the published position kernel do not. [Che18]
/// sec. 4.1.
/// @param interpolation nearest or bilinear.
device_types::mica_mixture_query to_mixture_query(const Query& query, const device_types::mica_map_grid& grid,
                                                  Interpolation interpolation, int elements, double cutoff);

/// The same where the footprint `without_needless_periods` is known.
device_types::mica_mixture_query to_mixture_query(const Query& query, const Footprint& footprint,
                                                  const device_types::mica_map_grid& grid,
                                                  Interpolation interpolation, int elements, double cutoff);

/// Cutoff that leaves out less than `relative_error` of the density's peak.
double cutoff_for(double relative_error);

}  // namespace mica::host
