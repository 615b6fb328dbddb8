#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host/surface/description.h"
#include "host/surface/local_filter.h"

namespace mica::host {

/// The P-NDF of a square of texels under a round Gaussian footprint in its middle, whose integral over all
/// half vectors is 1. Units are texels and any of normals.
class TileDensity {
 public:
  /// @param normals of texels, row by row; must outlive this. @param margin of texels that are left out.
  /// @param sigma of the footprint. @param roughness above 0.
  TileDensity(int side, const PairGrid& normals, Interpolation interpolation, int margin, double sigma,
              double roughness);

  /// @param looked_at grows by what that takes: triangles between texels, and their parts.
  double at(const Eigen::Vector2f& half_vector, int* looked_at) const;

  /// A half vector of the density at.
  Eigen::Vector2f draw(std::uint64_t seed, std::uint64_t number) const;

 private:
  /// Between four texels' centres, or one texel.
  struct Quad {
    Eigen::Vector2f corner, right, up, far;
    float weight;
  };
  bool reaches(const Quad& quad, const Eigen::Vector2f& half_vector) const;

  bool flat_;  ///< one normal a quad
  float roughness_;
  std::vector<Quad> quads_;
  std::vector<double> sums_;  ///< of weights up to each quad
};

}  // namespace mica::host
