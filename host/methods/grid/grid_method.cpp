#include <fmt/format.h>

#include "host/methods/grid/grid_brdf.h"
#include "host/methods/grid/grid_settings.h"
#include "host/methods/grid/grid_standard.h"
#include "host/methods/method.h"

namespace mica::host {
namespace {

constexpr std::size_t kMostColors = 8;
constexpr std::size_t kGridBatchQueries = std::size_t{1} << 17;

const GlintsDescription& glints_of(const MethodSettings& settings) {
  return *settings_as<GridSettings>(settings).glints();
}

class GridMethod : public Method {
 public:
  std::string name() const override { return "grid"; }
  std::string summary() const override {
    return "glints on an implicit grid, without a map, in constant time [Kem25]";
  }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.map = false;
    traits.brdf = true;
    traits.first_order = true;
    return traits;
  }
  std::unique_ptr<MethodSettings> settings() const override { return std::make_unique<GridSettings>(); }

  void check(const MethodSettings& settings) const override {
    Method::check(settings);
    const std::string problem = glint_grid_problem(grid_of(glints_of(settings)));
    if (!problem.empty()) throw UsageError("glints: " + problem);
  }

  StructureSize structure(const StructureAsked& asked, const MethodSettings& settings) const override {
    const GlintsDescription& glints = glints_of(settings);
    StructureSize size;
    size.kernel = "grid/grid.cl " + grid_kernel_options(glints.distribution, glint_features(glints));
    if (asked.brdf)
      size.kernel += ", grid/grid_brdf.cl " + grid_kernel_options(glints.distribution, draw_features(glints));
    return size;
  }

  /// Queries bring what glints are at their place with them; the colours alone belong to the material.
  bool share(const MethodSettings& a, const MethodSettings& b, bool gathers) const override {
    const StructureAsked asked;
    return !gathers && structure(asked, a).kernel == structure(asked, b).kernel &&
           glints_of(a).colors == glints_of(b).colors;
  }

  std::unique_ptr<Evaluator> make_own(Device* device, const Surface*,
                                      const MethodSettings& settings) const override {
    const GlintsDescription& glints = glints_of(settings);
    return std::make_unique<GridEvaluator>(*device, grid_of(glints), std::nullopt, kGridBatchQueries,
                                           glint_features(glints));
  }

  std::unique_ptr<PatchBrdf> make_own_brdf(Device* device, const Surface*,
                                           const MethodSettings& settings) const override {
    return std::make_unique<GridBrdf>(*device, glints_of(settings));
  }

  std::string own_query_problem(const Query& query, const Surface*) const override {
    return grid_query_problem(query);
  }

  std::unique_ptr<Standard> standard(const Surface*, const reference::Oracle*,
                                     const MethodSettings& settings) const override {
    return std::make_unique<GridStandard>(grid_of(glints_of(settings)));
  }

  /// As many cells as the map has texels, so that its footprints are as hard.
  std::unique_ptr<MethodSettings> settings_beside(int width, int height) const override {
    auto settings = std::make_unique<GridSettings>();
    read_settings({{"density", fmt::format("{}", 1.0 * width * height)}}, settings.get());
    return settings;
  }
};

}  // namespace

GridFeatures glint_features(const GlintsDescription& glints) {
  GridFeatures features;
  features.colors = std::max<int>(1, static_cast<int>(glints.colors.size()));
  features.roulette = glints.mapping == GlintsDescription::Mapping::triplanar ||
                      !glints.textures.density.empty() || !glints.textures.stretch.empty();
  return features;
}

GridFeatures draw_features(const GlintsDescription& glints) {
  GridFeatures features = glint_features(glints);
  features.colors = 1;
  return features;
}

void GridSettings::visit(SettingVisitor& visitor) {
  const bool of_job = visitor.source() == SettingSource::job;
  visitor.choice("distribution", "Smooth distribution that glints add up to: ggx or beckmann",
                 glints_.distribution);
  visitor.one_or_two("alpha", "Roughness of the smooth distribution, along u and v, 1e-4 to 1", glints_.alpha,
                     {1e-4, 1});
  visitor.number("density", "Cells per unit area of uv, of which pi/4 hold a glint, 1 to 1e12",
                 glints_.density, {1, 1e12});
  visitor.number("microroughness",
                 "Standard deviation of one glint's lobe on the disk, of all rows, 1e-4 to 1",
                 microroughness_, {1e-4, 1});
  visitor.number("stretch", "Of each glint along u, 1/64 to 64", glints_.stretch, {1.0 / 64, 64});
  visitor.seed("seed", "Of the glints of a grid", glints_.seed);
  if (of_job) visitor.choice("mapping", "Over uv or on three planes of the world", glints_.mapping);
  visitor.choice(of_job ? "masking" : "glint-masking", "Of the BRDF of glints: smith or cavity",
                 glints_.masking);
  visitor.colors("colors", "Each glint has one of them, at random", glints_.colors, kMostColors);
  GlintTextures& textures = glints_.textures;
  visitor.file("textures", "density", "Multiplies the density", textures.density);
  visitor.file("textures", "alpha", "Multiplies alpha", textures.alpha);
  visitor.file("textures", "microroughness", "Multiplies the microroughness", textures.microroughness);
  visitor.file("textures", "stretch", "Exponent of the stretch", textures.stretch);
  visitor.file("textures", "color", "Multiplies the reflection", textures.color);
}

MethodSettings::Problem GridSettings::problem() const {
  const bool has_direction = glints_.alpha.x() != glints_.alpha.y() || glints_.stretch != 1;
  if (glints_.mapping != GlintsDescription::Mapping::triplanar) return {};
  if (!has_direction && glints_.textures.stretch.empty()) return {};
  return {
      "mapping",
      "found glints with a direction on three planes, which have none in common; expected one alpha and no "
      "stretch, or mapping = \"uv\""};
}

std::shared_ptr<const Method> grid_method() {
  return std::make_shared<GridMethod>();
}

}  // namespace mica::host
