// A table of queries: the P-NDF of brushed metal under ten thousand footprints, by two methods.
#include <cmath>
#include <cstdio>
#include <vector>

#include "mica/mica.h"

int main() {
  try {
    const mica::Device device;
    std::printf("on %s\n", device.info().name.c_str());
    const mica::NormalMap map =
        mica::NormalMap::generate("brushed", {{"resolution", 512}, {"rms_slope", 0.2}});

    // Rows in any order; a table of the caller's own, float or double, does as well: mica::Queries::of_rows.
    std::vector<mica::Query> queries(10000);
    for (std::size_t n = 0; n < queries.size(); ++n) {
      mica::Query& query = queries[n];
      const double sigma = 2.0 / map.width();  // two texels
      query.u = std::fmod(0.37 * static_cast<double>(n), 1.0),
      query.v = std::fmod(0.61 * static_cast<double>(n), 1.0);
      query.cuu = query.cvv = sigma * sigma, query.cuv = 0;
      query.s = 0.1 * std::sin(static_cast<double>(n)), query.t = 0;
      query.roughness = 0.02;
    }

    const mica::Evaluator exact(device, map, "triangles");
    const mica::Evaluator fast(device, map, "gaussians", {{"elements", 2}});
    const std::vector<float> references = exact.evaluate(queries), densities = fast.evaluate(queries);

    double squares = 0, reference_squares = 0;
    for (std::size_t n = 0; n < queries.size(); ++n) {
      squares += std::pow(densities[n] - references[n], 2);
      reference_squares += std::pow(references[n], 2);
    }
    std::printf("%zu queries, relative L2 of %s against %s: %.2g\n", queries.size(), fast.method().c_str(),
                exact.method().c_str(), std::sqrt(squares / reference_squares));
    return 0;
  } catch (const mica::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
