#pragma once

#include <string>

#include "host/base/query.h"
#include "host/surface/description.h"
#include "kernels/types.h"

namespace mica::host {

/// Why a query with a first order cannot be evaluated, or empty when it can: lobes have standard deviations
/// of 1e-5 to 1 along their axes; half vectors turn by at most 2 over the footprint's standard deviation; and
/// where they turn, a footprint that no shorter one can replace has at most 16384 texels.
/// @param query of which the footprint is known to be good.
std::string first_order_problem(const Query& query, int map_width, int map_height);

/// Why a query's lobe is none, or empty when it is one whose standard deviations along its axes lie in
/// [least, most].
std::string lobe_problem(const Query& query, double least, double most);
/// Why a query's half vector cannot turn as it does, or empty: it is finite, and turns by at most 2 over the
/// footprint's standard deviation.
std::string turn_problem(const Query& query);

/// A query with the same answer on a periodic map, and a footprint that is no wider than it has to be.
Query without_needless_periods(const Query& query);

/// Axes of a query's lobe: rows of unit length over standard deviations, the major axis first.
struct LobeAxes {
  Eigen::Matrix2d whiten;
  Eigen::Vector2d sigma;
};
LobeAxes lobe_axes(const Query& query);

/// The same place and half vector with a round lobe of the same area, whose peak is as high, that does not
/// turn.
Query with_round_lobe(const Query& query);

/// Lobe and turn in the kernels' form.
device_types::mica_turned_lobe to_turned_lobe(const Query& query, const device_types::mica_map_grid& grid);

/// The query in the kernels' form, see `to_triangle_query`.
device_types::mica_turned_query to_turned_triangle_query(const Query& query,
                                                         const device_types::mica_map_grid& grid,
                                                         Interpolation interpolation, double cutoff);

/// The same, see `to_mixture_query`.
device_types::mica_turned_mixture_query to_turned_mixture_query(const Query& query,
                                                                const device_types::mica_map_grid& grid,
                                                                Interpolation interpolation, int elements,
                                                                double cutoff);

}  // namespace mica::host
