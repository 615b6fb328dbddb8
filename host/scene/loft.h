#pragma once

#include <functional>

#include "host/scene/mesh.h"

namespace mica::host {

/// Cross section of a long, thin, closed body at one place of its length, which runs along x.
struct LoftSection {
  double x;
  double middle_y;    ///< where the middle of its width is
  double half_width;  ///< 0 at both ends of the body
  double rim_z;       ///< height of its edges
  double depth;       ///< by which its middle lies deeper
  double thickness;   ///< in the middle; the edges are round
};

/// Adds the body that sections from q = 0 to q = 1 span. Texture coordinates are (x, y), so that texels have
/// one size, and brushing runs along the body; the rim, where the body is vertical, stretches them.
/// @param steps sections and points around each, at least 8.
void add_loft(const std::function<LoftSection(double q)>& section, int steps, int steps_around,
              TriangleMesh* mesh);

/// Scales a mesh whose length is one to `size`, and moves it to `center`.
void place_body(const Eigen::Vector3d& center, double size, TriangleMesh* mesh);

}  // namespace mica::host
