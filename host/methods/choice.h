#pragma once

#include <cstddef>
#include <string>
#include <tuple>

namespace mica::host {

/// Queries that are alike: footprints of one octave, roughnesses of half an octave. Of one with a first
/// order, the footprint is the place that its half vector picks, and the roughness that of its lobe where it
/// is narrow.
struct QueryClass {
  int size = 0;              ///< floor of log2 of sqrt(2) times the smaller standard deviation in texels
  int roughness = 0;         ///< floor of 2 log2 (roughness / 0.02)
  bool first_order = false;  ///< the half vector turns, or the lobe is not round

  friend bool operator<(const QueryClass& a, const QueryClass& b) {
    return std::tie(a.size, a.roughness, a.first_order) < std::tie(b.size, b.roughness, b.first_order);
  }
};

/// What a method that chooses among others chose for a class, and why.
struct AutoChoice {
  QueryClass kind;
  std::string evaluator;       ///< in words: "gaussians, 2 a texel and axis"
  std::size_t samples = 0;     ///< queries that it was judged by; 0: it keeps the tolerance by itself
  double relative_l2 = 0;      ///< of these
  double upper_bound = 0;      ///< of the relative L2 of all queries of the class, at 95% confidence
  double typical_density = 0;  ///< sum of squares of the samples' densities over their sum
  double share_of_bound = 1;   ///< of estimated errors, so that their squares add up to what the bound allows
  double cost = 0;             ///< ns of one core that a query is estimated to take
};

/// "footprints of about 4 texels, roughness from 0.02: triangles; relative L2 0, at most 0.0001 at 95%
/// confidence by 256 queries"
std::string words(const AutoChoice& choice);

}  // namespace mica::host
