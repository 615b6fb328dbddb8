#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/methods/auto/cost_model.h"
#include "host/methods/evaluator.h"
#include "host/methods/pyramid/pyramid_query.h"
#include "host/surface/surface.h"

namespace mica::host {

class PyramidStore;
class TriangleEvaluator;

enum class CandidateKind { pyramid, gaussians, triangles };

/// A way to answer that `auto` may take.
struct Candidate {
  CandidateKind kind = CandidateKind::triangles;
  std::string label;
  int elements = 0;                 ///< of mixtures, a texel and axis
  PyramidPrecision precision = {};  ///< of pyramids
  double tolerance = 0;             ///< of triangles
  std::unique_ptr<Evaluator> built = {};

  /// @param store of pyramids. @param triangles whose map other triangles share, or null.
  std::unique_ptr<Evaluator> make(Device& device, const Surface& surface,
                                  const std::shared_ptr<PyramidStore>& store,
                                  const TriangleEvaluator* triangles) const;
  CostModel cost_model(const Surface& surface, bool first_order) const;
  /// Core nanoseconds. @param roughness of the class, as QueryClass has it.
  double build_cost(const Surface& surface, int roughness) const;
};

/// All that may keep a tolerance: pyramids and mixtures, of each method from the cheapest to the most
/// precise, and at last triangles to the tolerance, and exact ones.
struct Candidates {
  std::vector<Candidate> all;
  std::size_t precise_pyramid = 0, triangles = 0, exact_triangles = 0;  ///< places in it
};
Candidates candidates_for(double tolerance, Interpolation interpolation);

}  // namespace mica::host
