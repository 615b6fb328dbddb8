#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/methods/map/map_structure.h"
#include "host/methods/method.h"
#include "host/methods/oracle_standard.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/methods/triangles/triangle_precision.h"
#include "mica/error.h"

namespace mica::host {
namespace {

double tolerance_of(const MethodSettings& settings) {
  return settings.tolerance.value_or(kExactTriangles);
}

class TrianglesMethod : public Method {
 public:
  std::string name() const override { return "triangles"; }
  std::string summary() const override { return "the triangulated map, integrated exactly [Yan14]"; }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.estimates_errors = traits.surface_normals = traits.keeps_tolerance = true;
    traits.first_order = true;
    return traits;
  }

  void check(const MethodSettings& settings) const override {
    const double tolerance = tolerance_of(settings);
    if (!(tolerance >= kExactTriangles && tolerance < 1))
      throw UsageError(fmt::format("tolerance {}: triangles take {} to 1; for less use --ndf reference",
                                   tolerance, kExactTriangles));
  }

  StructureSize structure(const StructureAsked& asked, const MethodSettings& settings) const override {
    const int level = triangle_precision(tolerance_of(settings)).level;
    return {
        map_structure_bytes(asked.width, asked.height), 0,
        fmt::format("triangles/triangles.cl -DMICA_INTERPOLATION={}", static_cast<int>(asked.interpolation)) +
            (level > 0 ? fmt::format(" -DMICA_PRECISION={}", level) : "")};
  }

  std::unique_ptr<Evaluator> make_own(Device* device, const Surface* surface,
                                      const MethodSettings& settings) const override {
    TriangleSettings own;
    own.tolerance = tolerance_of(settings);
    return std::make_unique<TriangleEvaluator>(*device, *surface, own);
  }

  std::unique_ptr<Standard> standard(const Surface*, const reference::Oracle* map,
                                     const MethodSettings& settings) const override {
    const double tolerance = tolerance_of(settings);
    return std::make_unique<OracleStandard>(*map, [tolerance](double roughness) {
      if (tolerance <= kExactTriangles) return Promise{relative_bound(roughness), kPeakBound};
      return Promise{std::max(tolerance, relative_bound(roughness)), tolerance};
    });
  }

  std::vector<MethodVariant> variants(const std::vector<int>&) const override {
    std::vector<MethodVariant> all;
    all.push_back({settings(), name(), ""});
    for (const double tolerance : {3e-4, 1e-3, 3e-3, 1e-2, kRoughTriangles}) {
      std::unique_ptr<MethodSettings> less = settings();
      less->tolerance = tolerance;
      all.push_back(
          {std::move(less), fmt::format("triangles, to {}", tolerance), fmt::format("{}", tolerance)});
    }
    return all;
  }

  OperationCounter counter(Device* device, const Surface* surface,
                           const MethodSettings& settings) const override {
    TriangleSettings own;
    own.tolerance = tolerance_of(settings);
    own.count_flops = true;
    return {std::make_unique<TriangleEvaluator>(*device, *surface, own), 1};
  }
};

}  // namespace

std::shared_ptr<const Method> triangles_method() {
  return std::make_shared<TrianglesMethod>();
}

}  // namespace mica::host
