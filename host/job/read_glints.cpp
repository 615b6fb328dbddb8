#include "host/job/read_job.h"

namespace mica::host {
namespace {

constexpr std::size_t kMostColors = 8;

using Mapping = GlintsDescription::Mapping;
using GlintMasking = GlintsDescription::Masking;

const Choices<Distribution> distributions = {{"ggx", Distribution::trowbridge_reitz},
                                             {"beckmann", Distribution::beckmann}};
const Choices<Mapping> mappings = {{"uv", Mapping::uv}, {"triplanar", Mapping::triplanar}};
const Choices<GlintMasking> glint_maskings = {{"smith", GlintMasking::smith},
                                              {"cavity", GlintMasking::cavity}};

void read_textures(TableReader& table, GlintTextures& textures) {
  table.read_file("density", textures.density);
  table.read_file("alpha", textures.alpha);
  table.read_file("microroughness", textures.microroughness);
  table.read_file("stretch", textures.stretch);
  table.read_file("color", textures.color);
}

}  // namespace

void read_glints(TableReader& material, MaterialDescription& description) {
  GlintsDescription& glints = description.glints.emplace();
  std::uint64_t seed = glints.seed;
  description.roughness = 0.02;
  material.read("distribution", glints.distribution, distributions);
  material.read_one_or_two("alpha", glints.alpha, closed(1e-4, 1));
  material.read("density", glints.density, closed(1, 1e12));
  material.read("microroughness", description.roughness, closed(1e-4, 1));
  material.read("stretch", glints.stretch, closed(1.0 / 64, 64));
  material.read("seed", seed);
  material.read("mapping", glints.mapping, mappings);
  material.read("masking", glints.masking, glint_maskings);
  material.read("colors", glints.colors, kMostColors, closed(0, 1));
  material.read_table("textures", [&](TableReader& table) { read_textures(table, glints.textures); });
  if (seed > 0xffffffffU) material.report("seed", "found more than 32 bits; expected a seed below 2^32");
  glints.seed = static_cast<std::uint32_t>(seed);
  if (glints.mapping == Mapping::triplanar) {
    const bool has_direction = glints.alpha.x() != glints.alpha.y() || glints.stretch != 1;
    if (has_direction || !glints.textures.stretch.empty())
      material.report("mapping",
                      "found glints with a direction on three planes, which have none in common; "
                      "expected one alpha and no stretch, or mapping = \"uv\"");
  }
}

}  // namespace mica::host
