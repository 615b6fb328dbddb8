#pragma once

#include <cstddef>
#include <string>

namespace mica::host {

/// Queries that are alike: footprints of one octave, roughnesses of half an octave.
struct QueryClass {
  int size = 0;       ///< floor of log2 of sqrt(2) times the smaller standard deviation in texels
  int roughness = 0;  ///< floor of 2 log2 (roughness / 0.02)

  friend bool operator<(const QueryClass& a, const QueryClass& b) {
    return a.size != b.size ? a.size < b.size : a.roughness < b.roughness;
  }
};

/// What a method that chooses among others chose for a class, and why.
struct AutoChoice {
  QueryClass kind;
  std::string evaluator;       ///< in words: "gaussians, 2 a texel and axis"
  std::size_t samples = 0;     ///< queries that it was judged by
  double relative_l2 = 0;      ///< of these
  double upper_bound = 0;      ///< of the relative L2 of all queries of the class, at 95% confidence
  double typical_density = 0;  ///< sum of squares of the samples' densities over their sum
  double cost = 0;             ///< ns of one core that a query is estimated to take
};

}  // namespace mica::host
