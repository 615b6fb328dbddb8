#include <xxhash.h>

#include "host/surface/surface.h"
#include "tests/job/job_text.h"

namespace mica::host::test::values_test {
namespace {

const std::string kFullJob = R"(
seed = 7

[image]
width = 640
height = 360
subpixels = 2
aovs = ["uv", "ndf"]
exposure = -1.5

[camera]
position = [1, 2.5, 3]
look_at = [0, 0.5, 0]
up = [0, 1, 0]
fov = 45

[surface.a]
generate = "spectrum"
resolution = 256
rms_slope = 0.3
correlation = 12.5
seed = 11
interpolation = "bicubic"

[surface.b]
generate = "flakes"
resolution = 300
flake_size = 9
alpha = 0.4
seed = 12

[surface.c]
file = "maps/c.png"
encoding = "height"
green = "down"
interpolation = "nearest"
invalid = "repair"
height_scale = 3

[surface.d]
file = "maps/c.png"

[material.metal]
surface = "a"
repeat = [24, 12]
ndf = "triangles"
roughness = 0.005
specular = { eta = [0.1, 0.2, 0.3], k = [1, 2, 3] }
diffuse = [0.1, 0.2, 0.3]

[material.plastic]
surface = "b"
specular = { ior = 1.4 }

[material.tint]
surface = "c"
specular = { color = [1, 0.5, 0.25] }

[[shape]]
type = "plane"
center = [1, 2, 3]
size = 4
material = "metal"

[[shape]]
type = "sphere"
center = [4, 5, 6]
radius = 2
material = "plastic"

[[shape]]
type = "shell"
center = [7, 8, 9]
size = 3
turns = 5.5
material = "tint"

[[shape]]
type = "mesh"
file = "cup.obj"
material = "tint"

[[light]]
type = "point"
position = [1, 2, 3]
intensity = [4, 5, 6]

[[light]]
type = "directional"
direction = [0, 0, -2]
irradiance = [7, 8, 9]

[background]
image = "sky.exr"

[audit]
samples = 99
)";

/// The full job, with the files that it names.
struct FullJob : testing::Test {
  FullJob() {
    std::filesystem::create_directories(folder.path("maps"));
    folder.write("maps/c.png", "x");
    folder.write("cup.obj", "x");
    folder.write("sky.exr", "x");
    job = folder.load(kFullJob);
  }
  JobFolder folder;
  Job job;
};

TEST_F(FullJob, ImageSeedAndAudit) {
  EXPECT_EQ(job.path, folder.path("job.toml"));
  EXPECT_EQ(job.seed, 7u);
  EXPECT_EQ(job.image.width, 640);
  EXPECT_EQ(job.image.height, 360);
  EXPECT_EQ(job.image.subpixels, 2);
  EXPECT_EQ(job.image.aovs, (std::vector<std::string>{"uv", "ndf"}));
  EXPECT_EQ(job.image.exposure, -1.5);
  EXPECT_EQ(job.audit.samples, 99);
}

TEST_F(FullJob, Camera) {
  EXPECT_EQ(job.scene.camera.position, Eigen::Vector3d(1, 2.5, 3));
  EXPECT_EQ(job.scene.camera.look_at, Eigen::Vector3d(0, 0.5, 0));
  EXPECT_EQ(job.scene.camera.up, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(job.scene.camera.fov_degrees, 45);
}

TEST_F(FullJob, GeneratedSurfaces) {
  ASSERT_EQ(job.surfaces.size(), 4u);
  const auto& spectrum = std::get<SpectrumSurface>(job.surfaces[0].source);
  EXPECT_EQ(job.surfaces[0].name, "a");
  EXPECT_EQ(spectrum.resolution, 256);
  EXPECT_EQ(spectrum.rms_slope, 0.3);
  EXPECT_EQ(spectrum.correlation_texels, 12.5);
  EXPECT_EQ(spectrum.seed, 11u);
  EXPECT_EQ(job.surfaces[0].interpolation, Interpolation::bicubic);

  const auto& flakes = std::get<FlakesSurface>(job.surfaces[1].source);
  EXPECT_EQ(flakes.resolution, 300);
  EXPECT_EQ(flakes.flake_size_texels, 9);
  EXPECT_EQ(flakes.alpha, 0.4);
  EXPECT_EQ(flakes.seed, 12u);
  EXPECT_EQ(job.surfaces[1].interpolation, Interpolation::nearest) << "flakes have constant normals";
}

TEST_F(FullJob, MapFiles) {
  const auto& map = std::get<MapFile>(job.surfaces[2].source);
  EXPECT_EQ(map.path, folder.path("maps/c.png"));
  EXPECT_TRUE(map.encoding_given);
  EXPECT_EQ(map.encoding, Encoding::height);
  EXPECT_EQ(map.green, GreenDirection::down);
  EXPECT_EQ(map.invalid, TexelRepair::repair);
  EXPECT_EQ(map.height_scale, 3);
  EXPECT_EQ(job.surfaces[2].interpolation, Interpolation::nearest);

  EXPECT_FALSE(std::get<MapFile>(job.surfaces[3].source).encoding_given);
  EXPECT_EQ(job.surfaces[3].interpolation, Interpolation::bilinear);
}

TEST_F(FullJob, Materials) {
  ASSERT_EQ(job.scene.materials.size(), 3u);
  const MaterialDescription& metal = job.scene.materials[0];
  EXPECT_EQ(metal.name, "metal");
  EXPECT_EQ(metal.surface, "a");
  EXPECT_EQ(metal.repeat, Eigen::Vector2d(24, 12));
  EXPECT_EQ(metal.ndf, "triangles");
  EXPECT_EQ(metal.roughness, 0.005);
  EXPECT_EQ(std::get<ConductorFresnel>(metal.specular).eta, Color(0.1, 0.2, 0.3));
  EXPECT_EQ(std::get<ConductorFresnel>(metal.specular).k, Color(1, 2, 3));
  EXPECT_EQ(metal.diffuse, Color(0.1, 0.2, 0.3));
  EXPECT_EQ(std::get<DielectricFresnel>(job.scene.materials[1].specular).ior, 1.4);
  EXPECT_EQ(std::get<ColorFresnel>(job.scene.materials[2].specular).color, Color(1, 0.5, 0.25));
}

TEST_F(FullJob, Shapes) {
  ASSERT_EQ(job.scene.shapes.size(), 4u);
  const auto& plane = std::get<PlaneShape>(job.scene.shapes[0].geometry);
  EXPECT_EQ(plane.center, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(plane.size, 4);
  const auto& sphere = std::get<SphereShape>(job.scene.shapes[1].geometry);
  EXPECT_EQ(sphere.center, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(sphere.radius, 2);
  const auto& shell = std::get<ShellShape>(job.scene.shapes[2].geometry);
  EXPECT_EQ(shell.center, Eigen::Vector3d(7, 8, 9));
  EXPECT_EQ(shell.size, 3);
  EXPECT_EQ(shell.turns, 5.5);
  EXPECT_EQ(std::get<MeshShape>(job.scene.shapes[3].geometry).path, folder.path("cup.obj"));
  EXPECT_EQ(job.scene.shapes[1].material, "plastic");
}

TEST_F(FullJob, LightsAndBackground) {
  ASSERT_EQ(job.scene.lights.size(), 2u);
  EXPECT_EQ(std::get<PointLight>(job.scene.lights[0]).position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(std::get<PointLight>(job.scene.lights[0]).intensity, Color(4, 5, 6));
  EXPECT_EQ(std::get<DirectionalLight>(job.scene.lights[1]).direction, Eigen::Vector3d(0, 0, -2));
  EXPECT_EQ(std::get<DirectionalLight>(job.scene.lights[1]).irradiance, Color(7, 8, 9));
  EXPECT_EQ(job.scene.background.path, folder.path("sky.exr"));
}

TEST(Values, AbsentKeysKeepTheirDefaults) {
  const JobFolder folder;
  const Job job = folder.load(kLeastJob);
  EXPECT_EQ(job.seed, Job().seed);
  EXPECT_EQ(job.image.width, ImageSettings().width);
  EXPECT_EQ(job.audit.samples, 0);
  EXPECT_EQ(job.scene.camera.fov_degrees, CameraDescription().fov_degrees);
  EXPECT_EQ(job.scene.materials[0].roughness, MaterialDescription().roughness);
  EXPECT_EQ(std::get<SpectrumSurface>(job.surfaces[0].source).rms_slope, SpectrumSurface().rms_slope);
  EXPECT_EQ(std::get<SphereShape>(job.scene.shapes[0].geometry).radius, SphereShape().radius);
}

TEST(Values, KindsOfSurfaces) {
  const JobFolder folder;
  const Job job = folder.load(R"(
[surface.a]
generate = "brushed"
resolution = 100
rms_slope = 0.3
correlation_along = 50
correlation_across = 5
direction = -30
seed = 2
[surface.b]
generate = "scratches"
resolution = 100
density = 0.7
length = 60
width = 5
depth = 0.4
variation = 0.2
direction = 10
spread = 20
bend = 0.1
profile = "v"
seed = 3
[surface.c]
generate = "dents"
resolution = 100
density = 0.8
radius = [3, 9]
depth = 0.2
seed = 4
[surface.d]
generate = "bumps"
resolution = 100
cell = 10
size = 0.6
aspect = 2
slope = 0.5
jitter = 0.1
seed = 5
[surface.e]
generate = "waves"
resolution = 100
patch = 300
wind_speed = 7
wind_direction = 45
time = 1.5
seed = 6
)" + kLeastJob);
  const auto& brushed = std::get<BrushedSurface>(job.surfaces[0].source);
  EXPECT_EQ(brushed.resolution, 100);
  EXPECT_EQ(brushed.rms_slope, 0.3);
  EXPECT_EQ(brushed.correlation_along_texels, 50);
  EXPECT_EQ(brushed.correlation_across_texels, 5);
  EXPECT_EQ(brushed.direction_degrees, -30);
  EXPECT_EQ(brushed.seed, 2u);
  const auto& scratches = std::get<ScratchesSurface>(job.surfaces[1].source);
  EXPECT_EQ(scratches.resolution, 100);
  EXPECT_EQ(scratches.density, 0.7);
  EXPECT_EQ(scratches.length_texels, 60);
  EXPECT_EQ(scratches.width_texels, 5);
  EXPECT_EQ(scratches.depth_texels, 0.4);
  EXPECT_EQ(scratches.variation, 0.2);
  EXPECT_EQ(scratches.direction_degrees, 10);
  EXPECT_EQ(scratches.spread_degrees, 20);
  EXPECT_EQ(scratches.bend, 0.1);
  EXPECT_EQ(scratches.profile, ScratchProfile::v);
  EXPECT_EQ(scratches.seed, 3u);
  const auto& dents = std::get<DentsSurface>(job.surfaces[3].source);
  EXPECT_EQ(job.surfaces[2].name, "bumps");  // the least job's: in the order of names
  EXPECT_EQ(dents.resolution, 100);
  EXPECT_EQ(dents.density, 0.8);
  EXPECT_EQ(dents.radius_low_texels, 3);
  EXPECT_EQ(dents.radius_high_texels, 9);
  EXPECT_EQ(dents.depth, 0.2);
  EXPECT_EQ(dents.seed, 4u);
  const auto& bumps = std::get<BumpsSurface>(job.surfaces[4].source);
  EXPECT_EQ(bumps.resolution, 100);
  EXPECT_EQ(bumps.cell_texels, 10);
  EXPECT_EQ(bumps.size, 0.6);
  EXPECT_EQ(bumps.aspect, 2);
  EXPECT_EQ(bumps.slope, 0.5);
  EXPECT_EQ(bumps.jitter, 0.1);
  EXPECT_EQ(bumps.seed, 5u);
  const auto& waves = std::get<WavesSurface>(job.surfaces[5].source);
  EXPECT_EQ(waves.resolution, 100);
  EXPECT_EQ(waves.patch_meters, 300);
  EXPECT_EQ(waves.wind_speed, 7);
  EXPECT_EQ(waves.wind_direction_degrees, 45);
  EXPECT_EQ(waves.time_seconds, 1.5);
  EXPECT_EQ(waves.seed, 6u);
}

TEST(Values, LayersHoldTheSurfacesThatTheyName) {
  const JobFolder folder;
  const Job job = folder.load(R"(
[surface.a]
generate = "layers"
layers = [{ surface = "z", weight = 0.5 }, { surface = "bumps" }]
interpolation = "bicubic"
[surface.z]
generate = "dents"
)" + kLeastJob,
                              {"surface.z.depth=0.3"});
  const auto& layers = std::get<LayersSurface>(job.surfaces[0].source).layers;
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(std::get<DentsSurface>(layers[0].surface.source).depth, 0.3);
  EXPECT_EQ(layers[0].weight, 0.5);
  EXPECT_TRUE(std::holds_alternative<SpectrumSurface>(layers[1].surface.source));
  EXPECT_EQ(layers[1].weight, 1);
  EXPECT_EQ(job.surfaces[0].interpolation, Interpolation::bicubic);
}

TEST(Values, DefaultLengthsFitSmallMaps) {
  const JobFolder folder;
  for (const std::string kind : {"spectrum", "brushed", "scratches", "dents", "bumps", "waves"}) {
    const Job job = folder.load(replaced(kLeastJob, "\"spectrum\"", '"' + kind + "\"\nresolution = 16"));
    EXPECT_NO_THROW(make_surface(job.surfaces[0], nullptr)) << kind;
  }
}

TEST(Values, InlineTablesMeanTheSame) {
  const JobFolder folder;
  const Job job = folder.load(R"(
shape = [{ type = "sphere", material = "gold" }]
light = [{ type = "point", position = [0, 0, 4] }]
material.gold = { surface = "bumps" }
surface.bumps.generate = "spectrum"
)");
  EXPECT_EQ(job.scene.shapes.size(), 1u);
  EXPECT_EQ(job.scene.materials[0].surface, "bumps");
}

TEST(Values, AbsoluteFileNamesStayAsTheyAre) {
  const JobFolder folder;
  folder.write("sky.exr", "x");
  const std::string sky = folder.path("sky.exr");
  EXPECT_EQ(folder.load(kLeastJob + "[background]\nimage = '" + sky + "'\n").scene.background.path, sky);
}

TEST(Values, EndsOfRangesAreAccepted) {
  const JobFolder folder;
  const std::string image = "[image]\nwidth = 1\nheight = 16384\nsubpixels = 16\n[audit]\nsamples = 0\n";
  EXPECT_EQ(folder.load(image + kLeastJob).image.subpixels, 16);
  EXPECT_EQ(folder.load("seed = 9223372036854775807\n" + kLeastJob).seed, 9223372036854775807u);
}

TEST(Hash, CoversTextAndOverridesAndNothingElse) {
  const JobFolder folder;
  const std::uint64_t hash = folder.load(kLeastJob).hash;
  EXPECT_EQ(hash, XXH3_64bits(kLeastJob.data(), kLeastJob.size()));
  folder.write("other.toml", kLeastJob);
  EXPECT_EQ(load_job(folder.path("other.toml"), {}).hash, hash);
  EXPECT_NE(folder.load(kLeastJob + "\n").hash, hash);
  EXPECT_NE(folder.load(kLeastJob, {"seed=1"}).hash, hash);
  EXPECT_NE(folder.load(kLeastJob, {"seed=1", "seed=2"}).hash,
            folder.load(kLeastJob, {"seed=2", "seed=1"}).hash);
}

class ShippedJob : public testing::TestWithParam<const char*> {};

TEST_P(ShippedJob, Loads) {
  const Job job = load_job(std::string(MICA_SOURCE_DIR "/data/jobs/") + GetParam(), {});
  EXPECT_FALSE(job.scene.shapes.empty());
  EXPECT_FALSE(job.scene.lights.empty() && job.scene.environments.empty());
}

INSTANTIATE_TEST_SUITE_P(Data, ShippedJob,
                         testing::Values("shell.toml", "paint.toml", "first.toml", "studio.toml"));

}  // namespace
}  // namespace mica::host::test::values_test
