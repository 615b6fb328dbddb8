#pragma once

#include <memory>

#include "host/methods/evaluator.h"

namespace mica::host {

class Surface;

/// An evaluator to which queries come with the lobes that the surface asks for (Surface::lobe_variance), and
/// whose answers that are not finite are replaced by the oracle's, and counted: one query that a
/// method cannot answer does not lose the others of its batch.
/// @param surface has to outlive what is made. Null: there is no oracle, and such an answer is a DeviceError.
std::unique_ptr<Evaluator> with_finite_answers(std::unique_ptr<Evaluator> evaluator, const Surface* surface);

}  // namespace mica::host
