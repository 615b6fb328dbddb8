#pragma once

#include <optional>
#include <tuple>

#include "host/base/query.h"
#include "host/methods/pyramid/moment_pyramid.h"
#include "host/surface/description.h"
#include "kernels/pyramid/pyramid_types.h"

namespace mica::host {

/// How closely `pyramid` merges. The defaults keep 1% relative L2.
struct PyramidPrecision {
  double block_ratio =
      1.4142135623730951;      ///< largest block side in the footprint's smaller standard deviations
  double cell_ratio = 1.5;     ///< largest cell width in roughnesses
  double cutoff_error = 3e-2;  ///< weight, of the largest, at which culling may drop an element
};

/// The level that a query reads. A function of the query and of which levels its map has.
struct PyramidChoice {
  int cell_class = 0;  ///< cells have a width of cell_width(cell_class, precision)
  int block = 0;       ///< texels; the whole map's for a footprint that wraps to a uniform one
  bool uniform = false;

  friend bool operator<(const PyramidChoice& a, const PyramidChoice& b) {
    return std::tie(a.cell_class, a.block, a.uniform) < std::tie(b.cell_class, b.block, b.uniform);
  }
};

/// Single precision keeps 0.1% of the determinant of a footprint with this ratio of its axes.
constexpr double kLargestAspect = 128;

/// Cells come in widths half an octave apart: those of roughness 0.02 and sqrt(2)^n times as much. The widest
/// that are not too wide for a roughness.
int cell_class_of(double roughness);
double cell_width(int cell_class, const PyramidPrecision& precision);

/// What a query takes of each level. Levels fade into each other, so that a zoom does not show where they
/// change: a footprint that is hardly wide enough for its own level takes a share of the one with half its
/// blocks, and one that is about to be uniform takes a share of that.
struct PyramidShares {
  PyramidChoice choice;  ///< its own level, which gets what the others leave
  double finer = 0;      ///< of what is not uniform, for the level with half the blocks, where there is one
  double uniform = 0;    ///< for the whole map at once
};

/// None when the footprint is too small for the finest level, or so thin that single precision cannot tell
/// its determinant.
/// @param finest_block of the levels of the query's class of cells.
std::optional<PyramidShares> shares_of(const Query& query, int map_width, int map_height, int finest_block,
                                       const PyramidPrecision& precision);

/// The query in the kernel's form. @param uniform of the choice.
device_types::mica_pyramid_query to_pyramid_query(const Query& query, const PyramidShape& level,
                                                  Interpolation interpolation, double cutoff, bool uniform);

/// The place that a query with a first order sees for its half vector, and the roughness of its lobe where
/// that is narrow: a level that suits them suits the query.
Query place_seen(const Query& query);

/// The query with its first order in the kernel's form.
device_types::mica_turned_pyramid_query to_turned_pyramid_query(const Query& query, const PyramidShape& level,
                                                                Interpolation interpolation, double cutoff,
                                                                bool uniform);

}  // namespace mica::host
