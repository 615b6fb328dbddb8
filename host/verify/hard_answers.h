#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/methods/registry.h"

namespace mica::host {

/// What became of many random questions to one method.
struct HardAnswers {
  std::string method;
  std::uint64_t answered = 0;  ///< finite and not negative
  std::uint64_t refused = 0;   ///< with a reason: turns over footprints that are too long for them
  std::uint64_t wrong = 0;     ///< not finite, negative, refused otherwise, or lost with their batch
  std::uint64_t replaced = 0;  ///< of those answered: not finite at first, see with_finite_answers
  std::string fault;           ///< of the first wrong one
  double seconds = 0;
};

/// Asks every method of the registry about maps that are hard, in ways that come together at random: one
/// normal all over, normals on the rim, opposite neighbours, flakes, steep noise, caustics, a single texel;
/// roughness 1e-4 to 1, footprints of 0.01 to 1000 texels (30 of BRDFs; one in 32 above 3), round or needles
/// up to a correlation of 1 - 1e-6; half vectors on a normal, in its lobe's far tail, or anywhere up to the
/// rim; of methods that take them, half vectors that turn and lobes that are not round. BRDFs are asked for
/// values, energies and draws at directions down to the horizon.
/// @param answers of each method, about; of BRDFs a fifth, of the reference a two-hundredth. @param first
/// number of the first question; others are other ones.
std::vector<HardAnswers> ask_hard_questions(Device& device, std::uint64_t answers, std::uint64_t first = 0,
                                            const MethodRegistry& methods = MethodRegistry::builtin());

}  // namespace mica::host
