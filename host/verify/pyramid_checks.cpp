#include "host/verify/pyramid_checks.h"

#include <fmt/format.h>

#include <cmath>

#include "host/base/error_norms.h"
#include "host/base/interrupt.h"
#include "host/methods/pyramid/pyramid_painter.h"
#include "host/reference/oracle.h"
#include "host/surface/texel_footprint.h"
#include "host/verify/accuracy.h"

namespace mica::host {
namespace {

constexpr double kAllowed = 0.01;  // relative L2

Surface bumps() {
  SurfaceDescription description;
  description.name = "selftest";
  description.source = SpectrumSurface{256, 0.15, 8, 3};
  return make_surface(description, nullptr);
}

Check compared(const std::string& name, const Surface& surface, const std::vector<Query>& queries,
               const std::vector<float>& densities) {
  check_interrupt();
  const std::vector<reference::OracleResult> expected = reference::Oracle(surface, 1e-4).evaluate(queries);
  RelativeL2 error;
  for (std::size_t n = 0; n < queries.size(); ++n) error.add(densities[n], expected[n].density);
  return {name, queries.size(), error.value() / kAllowed};
}

/// Half vectors near the normals under some footprints of one size.
Check check_queries(PyramidEvaluator* pyramid, const Surface& surface, double sigma_texels,
                    double roughness) {
  constexpr int footprints = 6, half_vectors = 8;
  std::vector<Query> queries;
  for (int n = 0; n < footprints; ++n) {
    const Eigen::Vector2d mean_uv(0.13 + 0.37 * n, 0.71 + 0.11 * n);
    const Footprint footprint = make_footprint(surface, mean_uv, sigma_texels, 0.7 * sigma_texels, 0.4 * n);
    for (const Query& query :
         probe(surface, footprint, roughness, half_vectors, static_cast<std::uint64_t>(n)))
      queries.push_back(query);
  }
  return compared(fmt::format("pyramid: footprint {}, roughness {}", sigma_texels, roughness), surface,
                  queries, pyramid->evaluate(queries));
}

Check check_image(PyramidEvaluator* pyramid, Device* device, const Surface& surface, double sigma_texels,
                  double roughness) {
  PyramidPainter painter(*device, surface, *pyramid);
  const ImageWindow window{{0, 0}, 0.4, 20};
  Query query{make_footprint(surface, {0.3, 0.8}, sigma_texels, sigma_texels, 0), {0, 0}, roughness};
  const std::vector<float> image = painter.paint({query}, window);
  std::vector<Query> queries(window.count(), query);
  for (std::size_t pixel = 0; pixel < queries.size(); ++pixel)
    queries[pixel].half_vector = window.half_vector(pixel);
  return compared(fmt::format("pyramid: image, footprint {}, roughness {}", sigma_texels, roughness), surface,
                  queries, image);
}

}  // namespace

std::vector<Check> check_pyramid(Device* device) {
  const Surface surface = bumps();
  PyramidEvaluator pyramid(*device, surface);
  return {check_queries(&pyramid, surface, 24, 0.02), check_queries(&pyramid, surface, 5000, 0.02),
          check_queries(&pyramid, surface, 60, 0.005), check_image(&pyramid, device, surface, 24, 0.02),
          check_image(&pyramid, device, surface, 8, 0.005)};
}

}  // namespace mica::host
