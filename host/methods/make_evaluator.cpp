#include "host/methods/make_evaluator.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/methods/beckmanns/beckmann_evaluator.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/pyramid/pyramid_evaluator.h"
#include "host/methods/smooth/smooth_evaluator.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "mica/error.h"

namespace mica::host {

const std::vector<std::string>& evaluator_names() {
  static const std::vector<std::string> names = {"triangles", "gaussians", "beckmanns", "smooth", "pyramid"};
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
  if (name == "smooth") return std::make_unique<SmoothEvaluator>(device, surface, mixture);
  throw UsageError(
      fmt::format("there is no evaluator \"{}\"; available: {}", name, fmt::join(evaluator_names(), ", ")));
}

}  // namespace mica::host
