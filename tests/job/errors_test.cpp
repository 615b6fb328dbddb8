#include "tests/job/job_text.h"

namespace mica::host::test::errors_test {
namespace {

/// One mistake: the first `from` of the least job is replaced by `to`, where `@` marks the place to be named.
struct Mistake {
  std::string from, to, message;
};

class Errors : public testing::TestWithParam<Mistake> {};

TEST_P(Errors, NamePlaceFindingAndExpectation) {
  std::string text = replaced(kLeastJob, GetParam().from, GetParam().to);
  const std::size_t mark = text.find('@');
  ASSERT_NE(mark, std::string::npos);
  text.erase(mark, 1);
  const std::string before = text.substr(0, mark);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const auto column = before.size() - (before.rfind('\n') + 1) + 1;  // npos + 1 is 0

  const JobFolder folder;
  const std::vector<JobIssue> issues = folder.issues(text);
  ASSERT_EQ(issues.size(), 1u) << (issues.empty() ? "" : JobError(issues).what());
  EXPECT_EQ(issues[0].message, GetParam().message);
  EXPECT_EQ(issues[0].line, line);
  EXPECT_EQ(issues[0].column, int(column));
  EXPECT_EQ(issues[0].file, folder.path("job.toml"));
}

const char* const surface_keys = "resolution, rms_slope, correlation, seed";

const std::vector<Mistake> kUnknownKeys = {
    {"", "[image]\n  @widht = 3",
     "image.widht: found an unknown key; expected one of: width, height, subpixels, filter, "
     "filter_width, samples, max_bounces, "
     "aovs, exposure, tone_map "
     "(did you mean \"width\"?)"},
    {"", "[audit]\n@turbo = 1", "audit.turbo: found an unknown key; expected one of: samples, pixels"},
    {"", "[@lights]",
     "lights: found an unknown key; expected one of: seed, image, frames, surface, camera, material, shape, "
     "light, "
     "background, accuracy, audit (did you mean \"light\"?)"},
    {"\"spectrum\"", "\"spectrum\"\n@flake_size = 3",
     std::string("surface.bumps.flake_size: found an unknown key; expected one of: generate, ") +
         surface_keys + ", interpolation"},
    {"\"bumps\"", "\"bumps\"\nspecular = { ior = 1.5, @kk = 1 }",
     "material.gold.specular.kk: found an unknown key; expected \"ior\""},
    {"\"bumps\"", "\"bumps\"\n@\"a b\" = 1",
     "material.gold.\"a b\": found an unknown key; expected one of: repeat, ndf, surface, roughness, "
     "elements, "
     "masking, "
     "energy_bound, tolerance, "
     "specular, "
     "diffuse, multiple_scattering, id, coat"},
};
INSTANTIATE_TEST_SUITE_P(UnknownKey, Errors, testing::ValuesIn(kUnknownKeys));

const std::vector<Mistake> kWrongTypes = {
    {"", "[image]\nwidth = @\"wide\"",
     "image.width: found \"wide\" (a string); expected an integer in [1, 16384]"},
    {"", "[image]\nwidth = @4.0", "image.width: found 4 (a float); expected an integer in [1, 16384]"},
    {"", "[image]\nwidth = @true", "image.width: found true; expected an integer in [1, 16384]"},
    {"", "[image]\nwidth = @2024-01-01",
     "image.width: found a date or time; expected an integer in [1, 16384]"},
    {"", "image = @3", "image: found 3; expected a table"},
    {"", "@[[image]]", "image: found an array; expected a table"},
    {"", "[camera]\nfov = @[1]", "camera.fov: found an array; expected a number in (0, 180)"},
    {"", "[camera]\nposition = @7",
     "camera.position: found 7; expected an array of 3 numbers in [-100000000, 100000000]"},
    {"", "[camera]\nposition = @[1, 2]",
     "camera.position: found an array of 2; expected an array of 3 numbers in [-100000000, 100000000]"},
    {"", "[camera]\nposition = [1, 2,\n @{}]",
     "camera.position.2: found a table; expected a number in [-100000000, 100000000]"},
    {"", "[image]\naovs = @\"uv\"",
     "image.aovs: found \"uv\" (a string); expected an array with any of: ndf, uv, footprint, normal, "
     "queries, error"},
    {"\"bumps\"", "@[\"bumps\"]",
     "material.gold.surface: found an array; expected a string that is not empty"},
    {"\"sphere\"", "@1",
     "shape.0.type: found 1; expected one of: plane, sphere, shell, jar, spoon, fork, mesh"},
    {"[surface.bumps]", "[surface]\nextra = @1\n[surface.bumps]",
     "surface.extra: found 1; expected a table, headed [surface.NAME]"},
    {"[[light]]", "@[light]", "light: found a table; expected an array of tables, each headed [[light]]"},
    {"", "seed = @\"x\"", "seed: found \"x\" (a string); expected an integer from 0 below 2^63"},
};
INSTANTIATE_TEST_SUITE_P(WrongType, Errors, testing::ValuesIn(kWrongTypes));

const std::vector<Mistake> kMissingKeys = {
    {"[surface.bumps]\ngenerate = \"spectrum\"", "@[surface.bumps]",
     "surface.bumps: found neither of \"file\" and \"generate\"; expected exactly one"},
    {"[material.gold]\nsurface = \"bumps\"", "@[material.gold]",
     "material.gold: found no key \"surface\"; expected the name of a surface"},
    {"[[shape]]\ntype = \"sphere\"", "@[[shape]]",
     "shape.0: found no key \"type\"; expected one of: plane, sphere, shell, jar, spoon, fork, mesh"},
    {"[[shape]]\ntype = \"sphere\"\nmaterial = \"gold\"", "@[[shape]]\ntype = \"sphere\"",
     "shape.0: found no key \"material\"; expected the name of a material"},
    {"[[shape]]\ntype = \"sphere\"", "@[[shape]]\ntype = \"mesh\"",
     "shape.0: found no key \"file\"; expected a Wavefront OBJ file"},
    {"[[light]]\ntype = \"point\"", "@[[light]]",
     "light.0: found no key \"type\"; expected one of: point, directional, sphere, disk, environment, "
     "furnace"},
    {"[[light]]\ntype = \"point\"\nposition = [0, 0, 4]", "@[[light]]\ntype = \"point\"",
     "light.0: found no key \"position\"; expected an array of 3 numbers"},
    {"[[light]]\ntype = \"point\"\nposition = [0, 0, 4]", "@[[light]]\ntype = \"directional\"",
     "light.0: found no key \"direction\"; expected an array of 3 numbers"},
    {"[[light]]\ntype = \"point\"\nposition = [0, 0, 4]", "@[[light]]\ntype = \"environment\"",
     "light.0: found no key \"image\"; expected a lat-long EXR or HDR image"},
    {"\"bumps\"", "\"bumps\"\nspecular = @{ eta = [1, 1, 1] }",
     "material.gold.specular: found no key \"k\"; expected it beside \"eta\""},
};

INSTANTIATE_TEST_SUITE_P(MissingKey, Errors, testing::ValuesIn(kMissingKeys));

const std::vector<Mistake> kOutOfRange = {
    {"", "[image]\nwidth = @0", "image.width: found 0; expected an integer in [1, 16384]"},
    {"", "[image]\nwidth = @99999999999",
     "image.width: found 99999999999; expected an integer in [1, 16384]"},
    {"", "[image]\nsubpixels = @17", "image.subpixels: found 17; expected an integer in [1, 16]"},
    {"", "[image]\nsamples = @0", "image.samples: found 0; expected an integer in [1, 65536]"},
    {"", "[image]\nmax_bounces = @65", "image.max_bounces: found 65; expected an integer in [1, 64]"},
    {"[[light]]\ntype = \"point\"\nposition = [0, 0, 4]",
     "[[light]]\ntype = \"furnace\"\nradiance = [0, @-1, 0]",
     "light.0.radiance.1: found -1; expected a number in [0, 1000000000]"},
    {"", "[image]\nexposure = @99", "image.exposure: found 99; expected a number in [-32, 32]"},
    {"", "[camera]\nfov = @0", "camera.fov: found 0; expected a number in (0, 180)"},
    {"", "[camera]\nfov = @180.0", "camera.fov: found 180 (a float); expected a number in (0, 180)"},
    {"", "[camera]\nfov = @nan", "camera.fov: found nan (a float); expected a number in (0, 180)"},
    {"", "[camera]\nup = [0, @-inf, 1]",
     "camera.up.1: found -inf (a float); expected a number in [-100000000, 100000000]"},
    {"", "[audit]\nsamples = @-1", "audit.samples: found -1; expected an integer in [0, 1000000]"},
    {"", "seed = @-1", "seed: found -1; expected an integer from 0 below 2^63"},
    {"\"spectrum\"", "\"spectrum\"\nresolution = @3",
     "surface.bumps.resolution: found 3; expected an integer in [4, 16384]"},
    {"\"spectrum\"", "\"spectrum\"\nresolution = 64\ncorrelation = @65",
     "surface.bumps.correlation: found 65; expected a number in (0, 64]"},
    {"\"spectrum\"", "\"flakes\"\nresolution = 100\nflake_size = @26",
     "surface.bumps.flake_size: found 26; expected a number in [1, 25]"},
    {"\"bumps\"", "\"bumps\"\nroughness = @0",
     "material.gold.roughness: found 0; expected a number in [0.0001, 1]"},
    {"\"bumps\"", "\"bumps\"\nrepeat = [1, @0]",
     "material.gold.repeat.1: found 0; expected a number in (0, 1000000]"},
    {"\"bumps\"", "\"bumps\"\ndiffuse = [0, @1.5, 0]",
     "material.gold.diffuse.1: found 1.5 (a float); expected a number in [0, 1]"},
    {"\"bumps\"", "\"bumps\"\nspecular = { ior = @0.5 }",
     "material.gold.specular.ior: found 0.5 (a float); expected a number in [1, 10]"},
    {"\"sphere\"", "\"sphere\"\nradius = @-1", "shape.0.radius: found -1; expected a number in (0, 1000000]"},
    {"4]", "4]\nintensity = [1, 1, @-1]",
     "light.0.intensity.2: found -1; expected a number in [0, 1000000000]"},
};

/// Mistakes in kinds of surfaces; \"bumps\" of the least job becomes that kind.
const std::vector<Mistake> kSurfaceMistakes = {
    {"\"spectrum\"", "\"brushed\"\nresolution = 64\ncorrelation_across = @65",
     "surface.bumps.correlation_across: found 65; expected a number in [0.001, 64]"},
    {"\"spectrum\"", "\"scratches\"\nlength = 10\nwidth = @11",
     "surface.bumps.width: found 11; expected a number in [1, 10]"},
    {"\"spectrum\"", "\"scratches\"\nprofile = @\"w\"",
     "surface.bumps.profile: found \"w\" (a string); expected one of: v, rounded (did you mean \"v\"?)"},
    {"\"spectrum\"", "\"dents\"\nradius = @[9, 3]",
     "surface.bumps.radius: found 9 before 3; expected the least before the greatest"},
    {"\"spectrum\"", "\"bumps\"\naspect = @0", "surface.bumps.aspect: found 0; expected a number in [1, 10]"},
    {"\"spectrum\"", "\"waves\"\nwind_speed = @0",
     "surface.bumps.wind_speed: found 0; expected a number in [1e-06, 100]"},
    {"[surface.bumps]\ngenerate = \"spectrum\"",
     "[surface.a]\ngenerate = \"dents\"\n[surface.bumps]\ngenerate = \"layers\"\nlayers = [{ surface = "
     "@\"b\" }]",
     "surface.bumps.layers.0.surface: found \"b\"; expected the name of a surface, one of: a, bumps (did you "
     "mean \"a\"?)"},
    {"\"spectrum\"", "\"layers\"\nlayers = [{ surface = @\"bumps\" }]",
     "surface.bumps.layers.0.surface: found \"bumps\", which is made of layers itself; expected a surface "
     "that is "
     "not"},
    {"[surface.bumps]\ngenerate = \"spectrum\"",
     "[surface.a]\ngenerate = \"dents\"\nresolution = 64\n[surface.b]\ngenerate = \"dents\"\nresolution = "
     "32\n[surface.bumps]\ngenerate = \"layers\"\nlayers = [{ surface = \"a\" }, { surface = @\"b\" }]",
     "surface.bumps.layers.1.surface: found a resolution of 32; expected 64, as of the layers before it"},
    {"\"spectrum\"", "\"layers\"\nlayers = @[]",
     "surface.bumps.layers: found no [[layers]]; expected at least one"},
    {"\"spectrum\"", "\"layers\"\nlayers = [@{ weight = 2 }]",
     "surface.bumps.layers.0: found no key \"surface\"; expected the name of a surface that is not made of "
     "layers"},
};
INSTANTIATE_TEST_SUITE_P(Surfaces, Errors, testing::ValuesIn(kSurfaceMistakes));

INSTANTIATE_TEST_SUITE_P(OutOfRange, Errors, testing::ValuesIn(kOutOfRange));

const std::vector<Mistake> kWrongWords = {
    {"\"spectrum\"", "@\"spectrun\"",
     "surface.bumps.generate: found \"spectrun\" (a string); expected one of: spectrum, flakes, brushed, "
     "scratches, "
     "dents, bumps, waves, layers (did you mean "
     "\"spectrum\"?)"},
    {"\"spectrum\"", "\"spectrum\"\ninterpolation = @\"cubic\"",
     "surface.bumps.interpolation: found \"cubic\" (a string); expected one of: nearest, bilinear, bicubic "
     "(did "
     "you mean \"bicubic\"?)"},
    {"\"bumps\"", "@\"bump\"",
     "material.gold.surface: found \"bump\"; expected the name of a surface, \"bumps\" (did you mean "
     "\"bumps\"?)"},
    {"material = \"gold\"", "material = @\"silver\"",
     "shape.0.material: found \"silver\"; expected the name of a material, \"gold\""},
    {"\"bumps\"", "\"bumps\"\nndf = @\"reference\"",
     "material.gold.ndf: found \"reference\", which is not available in this version; expected an evaluator "
     "that "
     "is available: triangles, gaussians, beckmanns, smooth, cavities, pyramid, auto, grid, normalmap"},
    {"\"bumps\"", "\"bumps\"\nndf = @\"triangle\"",
     "material.gold.ndf: found \"triangle\"; expected an evaluator that is available: triangles, gaussians, "
     "beckmanns, smooth, cavities, pyramid, auto, grid, normalmap (did you mean \"triangles\"?)"},
    {"", "[image]\naovs = [\"uv\", @\"depth\"]",
     "image.aovs.1: found \"depth\" (a string); expected one of: ndf, uv, footprint, normal, queries, error"},
    {"", "[image]\naovs = [\"uv\", @\"uv\"]", "image.aovs.1: found \"uv\" again; expected each at most once"},
    {"[surface.bumps]", "@[surface.\"\"]\n[surface.bumps]",
     "surface.\"\": found an empty name; expected one that can be referred to"},
    {"\"bumps\"", "@\"\"",
     "material.gold.surface: found \"\" (a string); expected a string that is not empty"},
};
INSTANTIATE_TEST_SUITE_P(WrongWord, Errors, testing::ValuesIn(kWrongWords));

const std::vector<Mistake> kContradictions = {
    {"[surface.bumps]", "@[surface.bumps]\nfile = \"x.png\"",
     "surface.bumps: found both of \"file\" and \"generate\"; expected exactly one"},
    {"", "[camera]\nposition = [1, 2, 3]\nlook_at = @[1, 2, 3]",
     "camera.look_at: found the camera's position; expected another point"},
    {"", "[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\nup = @[0, 0, 2]",
     "camera.up: found no direction across the view; expected one that is not parallel to it"},
    {"", "[camera]\nup = @[0, 0, 0]",
     "camera.up: found no direction across the view; expected one that is not parallel to it"},
    {"\"point\"\nposition = [0, 0, 4]", "\"directional\"\ndirection = @[0, 0, 0]",
     "light.0.direction: found no length; expected the direction in which the light travels"},
    {"\"bumps\"", "\"bumps\"\nspecular = @{ ior = 1.5, color = [1, 1, 1] }",
     "material.gold.specular: found no single kind of reflection; expected { eta, k }, { ior } or { color }"},
    {"\"bumps\"", "\"bumps\"\nspecular = @{}",
     "material.gold.specular: found no single kind of reflection; expected { eta, k }, { ior } or { color }"},
};
INSTANTIATE_TEST_SUITE_P(Contradiction, Errors, testing::ValuesIn(kContradictions));

}  // namespace
}  // namespace mica::host::test::errors_test
