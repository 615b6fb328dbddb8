#include "host/engine/make_evaluator.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/base/error.h"
#include "host/engine/beckmann_evaluator.h"
#include "host/engine/mixture_evaluator.h"
#include "host/engine/pyramid_evaluator.h"
#include "host/engine/triangle_evaluator.h"

namespace mica {

const std::vector<std::string>& evaluator_names() {
  static const std::vector<std::string> names = {"triangles", "gaussians", "beckmanns", "pyramid"};
  return names;
}

std::unique_ptr<Evaluator> make_evaluator(const std::string& name, Device& device, const Surface& surface,
                                          int elements) {
  if (name == "triangles") return std::make_unique<TriangleEvaluator>(device, surface);
  if (name == "pyramid") return std::make_unique<PyramidEvaluator>(device, surface);
  MixtureSettings mixture;
  mixture.elements = elements;
  if (name == "gaussians") return std::make_unique<GaussianEvaluator>(device, surface, mixture);
  if (name == "beckmanns") return std::make_unique<BeckmannEvaluator>(device, surface, mixture);
  throw UsageError(
      fmt::format("there is no evaluator \"{}\"; available: {}", name, fmt::join(evaluator_names(), ", ")));
}

}  // namespace mica
