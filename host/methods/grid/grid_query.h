#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/base/glints.h"
#include "host/base/query.h"
#include "kernels/types.h"

namespace mica::host {

/// What a surface of glints without a map is made of. [Kem25] Table 1.
struct GlintGrid {
  Distribution distribution = Distribution::trowbridge_reitz;
  double alpha_x = 0.3, alpha_y = 0.3;  ///< roughness of the smooth distribution, 1e-4 to 1
  double density = 1e6;                 ///< cells per unit area of uv, 1 to 1e12; pi/4 of them hold a glint
  double stretch = 1;                   ///< of each glint along u, and of its lobe along t; 1/64 to 64
  std::uint32_t seed = 1;

  GlintPoint point() const;  ///< the same everywhere
};

/// Why a grid cannot be evaluated, or empty when it can.
std::string glint_grid_problem(const GlintGrid& grid);

/// Why a query cannot be evaluated on a grid, or empty when it can. Its roughness or lobe is that of a single
/// glint (the microroughness), 1e-4 to 1 along each axis; the half vector turns by at most 2 over the
/// footprint's standard deviation; covariances may be degenerate; |uv| is at most 1e7.
std::string grid_query_problem(const Query& query);

/// A batch in the kernels' form, padded to whole work-groups: see MICA_GLINT_FIELDS.
struct GridBatch {
  std::size_t pitch = 0;             ///< queries with padding
  std::vector<std::int32_t> fields;  ///< MICA_GLINT_FIELDS x pitch, or as many as turned queries have; floats
                                     ///< by their bits
};

/// Queries [first, first + count) of a batch, whose cells are found in double precision. @param points one
/// for all queries, or one for each. @param turned whether half vectors may turn and lobes need not be round.
///
/// The level of detail l is where the footprint's larger standard deviation is an eighth to a quarter of a
/// cell, so that 2x2 cells always hold the footprint to 3e-3 of its weight [Kem25 sec. 3.3.2]. Footprints are
/// widened by 1/128 of a cell: a degenerate one would see a glint, if any, as an infinite spike.
GridBatch to_grid_batch(const std::vector<Query>& queries, std::size_t first, std::size_t count,
                        const std::vector<GlintPoint>& points, bool turned = false);

}  // namespace mica::host
