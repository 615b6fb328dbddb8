// What a mixture's culling may drop.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/surface/texel_footprint.h"
#include "tests/methods/bilinear_samples.h"

namespace mica::host {

/// Culling at a weight of e drops at most a share of e (1 - ln e) of the integral: position and normal are
/// four Gaussian numbers. It adds nothing.
/// @param evaluator culls by default; @param fine next to nothing.
inline void expect_culling_drops_little(const Surface& surface, Evaluator* evaluator, Evaluator* fine) {
  const double error = MixtureSettings().cutoff_error;
  for (const double roughness : {0.005, 0.05}) {
    for (const double sigma_texels : {2.0, 6.0}) {
      const Footprint footprint = make_footprint(surface, {0.37, 0.61}, sigma_texels, 0.6 * sigma_texels, 1);
      const std::vector<Query> queries = lattice_queries(surface, footprint, roughness);
      const std::vector<float> densities = evaluator->evaluate(queries), all = fine->evaluate(queries);
      double dropped = 0, sum = 0;
      for (std::size_t n = 0; n < queries.size(); ++n) {
        EXPECT_LE(densities[n], (1 + 1e-6) * all[n]);
        dropped += all[n] - densities[n], sum += all[n];
      }
      EXPECT_LE(dropped / sum, error * (1 - std::log(error)));
      std::printf("roughness %g, footprint %g: %.1e dropped\n", roughness, sigma_texels, dropped / sum);
    }
  }
}

}  // namespace mica::host
