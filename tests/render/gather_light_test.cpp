#include "host/render/gather_light.h"
#include "host/base/constants.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>

#include "host/image/image.h"
#include "host/microfacet/masking.h"
#include "host/render/render.h"
#include "tests/temporary_path.h"

namespace mica::host::gather_light_test {
namespace {

/// A plane, seen from a few degrees or, with a narrow `fov`, all alike.
std::string plane_job(const std::string& material, const std::string& lights, double fov,
                      const std::string& image = "", int pixels = 24) {
  const std::string path = temporary_path("gather_light_test.toml");
  std::ofstream(path) << "[image]\nwidth = " << pixels << "\nheight = " << pixels << "\nsubpixels = 1\n"
                      << image << "\n[camera]\nposition = [0.0, -3.0, 2.0]\nfov = " << fov << R"(
[surface.flat]
generate = "spectrum"
resolution = 16
rms_slope = 0
[surface.noise]
generate = "spectrum"
resolution = 64
rms_slope = 0.25
correlation = 8
[material.m]
)" << material << "\n[[shape]]\ntype = \"plane\"\nmaterial = \"m\"\nsize = 100\n"
                      << lights;
  return path;
}

const std::string kChalk = "surface = \"flat\"\nspecular = { ior = 1 }\ndiffuse = [0.8, 0.5, 0.2]\n";
const std::string kFurnace = "[[light]]\ntype = \"furnace\"\nradiance = [1, 2, 3]\n";

Image render_job(const std::string& path, Techniques techniques, int rows_a_block = 0,
                 std::size_t batch = 0) {
  const Job job = load_job(path, {});
  Plan plan = make_plan(job);
  plan.techniques = techniques;
  if (rows_a_block) plan.rows_a_block = rows_a_block;
  if (batch) plan.queries_a_batch = batch;
  Device device(0);
  return render(job, plan, device, [](int, int) {}).image;
}

struct Mean {
  double mean, error;  ///< and its standard deviation
};

/// The mean over pixels that are independent and alike.
Mean mean_of(const Image& image, int channel) {
  double sum = 0, squares = 0;
  const double count = image.width * image.height;
  for (std::size_t n = static_cast<std::size_t>(channel); n < image.pixels.size(); n += 3)
    sum += image.pixels[n], squares += std::pow(image.pixels[n], 2);
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / (count - 1))};
}

void expect_mean(const Image& image, const Color& expected, double tolerance = 1e-6) {
  for (int channel = 0; channel < 3; ++channel) {
    const Mean found = mean_of(image, channel);
    EXPECT_NEAR(found.mean, expected[channel], 4.5 * found.error + tolerance * expected[channel])
        << "channel " << channel << ", standard error " << found.error;
  }
}

/// Writes an image of `radiance(direction)`, whose rows are fine enough to be taken for all directions.
template <typename Function>
std::string environment(const Function& radiance) {
  constexpr int width = 128, height = 64;
  Image image{width, height, {"R", "G", "B"}, {}, {}};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const double right = (column + 0.5 - width / 2) / width * 2 * kPi, down = (row + 0.5) / height * kPi;
      const Color color = radiance(Eigen::Vector3d(std::sin(right) * std::sin(down),
                                                   std::cos(right) * std::sin(down), std::cos(down)));
      for (const double c : {color[0], color[1], color[2]}) image.pixels.push_back(static_cast<float>(c));
    }
  const std::string path = temporary_path("gather_light_test.exr");
  write_exr(path, image);
  return "[[light]]\ntype = \"environment\"\nimage = \"" + path + "\"\n";
}

TEST(GatherLight, DiffusePlaneInAFurnaceShowsItsAlbedo) {
  const std::string job = plane_job(kChalk, kFurnace, 40, "samples = 16");
  for (const Techniques techniques : {Techniques::both, Techniques::lights, Techniques::brdf})
    expect_mean(render_job(job, techniques), {0.8, 1.0, 0.6});
}

TEST(GatherLight, DiffusePlaneReflectsTheIrradiance) {
  // L = 1 + 2 theta, of which bilinear pixels are exact; its irradiance is kPi + kPi^2 / 2.
  const std::string sky =
      environment([](const Eigen::Vector3d& d) { return Color::Constant(1 + 2 * std::acos(d.z())); });
  const std::string job = plane_job(kChalk, sky, 40, "samples = 16");
  const Color expected = Color(0.8, 0.5, 0.2) * (1 + kPi / 2);
  for (const Techniques techniques : {Techniques::both, Techniques::lights, Techniques::brdf})
    expect_mean(render_job(job, techniques), expected, 1e-4);  // the pole's pixel is constant, not linear
}

/// A sky with a lamp in it: both techniques are needed.
Color lamp_sky(const Eigen::Vector3d& d) {
  const double lamp = std::exp(-60 * (d - Eigen::Vector3d(0.3, 0.7, 0.65).normalized()).squaredNorm());
  return {0.3 + d.z() * d.z() + 20 * lamp, 1 + 0.5 * d.x() + 2 * lamp, 0.2 + 10 * lamp};
}

/// Radiance of a flat map of roughness `r` along `o`: [Yan14] Eq. 1 with D = exp(-|s|^2 / 2 r^2) / 2 kPi r^2.
Color flat_radiance(const Eigen::Vector3d& o, double r) {
  constexpr int steps = 700;
  Color sum = Color::Zero();
  for (int j = 0; j < steps; ++j)
    for (int k = 0; k < 2 * steps; ++k) {
      const double z = (j + 0.5) / steps, azimuth = kPi * (k + 0.5) / steps, radius = std::sqrt(1 - z * z);
      const Eigen::Vector3d i(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
      const Eigen::Vector3d h = (o + i).normalized();
      const double D = std::exp(-h.head<2>().squaredNorm() / (2 * r * r)) / (2 * kPi * r * r);
      sum += lamp_sky(i) * (D * smith_masking_shadowing(o.z(), i.z(), std::sqrt(2.0) * r) / (4 * o.z()));
    }
  return sum * 2 * kPi / (2.0 * steps * steps);
}

TEST(GatherLight, DrawsOfAPixelAreEvenTogether) {
  const std::string sky =
      environment([](const Eigen::Vector3d& d) { return Color::Constant(1 + 2 * std::acos(d.z())); });
  const auto error = [&](int subpixels, int samples) {
    std::string job = plane_job(kChalk, sky, 2, "samples = " + std::to_string(samples));
    std::ifstream file(job);
    std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    text.replace(text.find("subpixels = 1"), 13, "subpixels = " + std::to_string(subpixels));
    std::ofstream(job) << text;
    return mean_of(render_job(job, Techniques::both), 0).error;
  };
  // 64 draws apart would have an eighth of the error of one.
  EXPECT_LT(error(8, 1), error(1, 1) / 8 / 2);
}

TEST(GatherLight, AFurnaceAsksForNoDensityOfNormals) {
  const std::string material =
      "surface = \"noise\"\nroughness = 0.1\nrepeat = [40, 40]\nndf = \"triangles\"\n";
  const Job job = load_job(plane_job(material, kFurnace, 40, "samples = 16"), {});
  Plan plan = make_plan(job);
  Device device(0);
  const auto asked = [&] { return render(job, plan, device, [](int, int) {}).queries; };
  EXPECT_EQ(asked(), 0u);
  plan.techniques = Techniques::lights;
  EXPECT_GT(asked(), 0u);
}

TEST(GatherLight, GlossyPlaneReflectsTheSky) {
  const std::string sky = environment(lamp_sky);
  for (const double roughness : {0.1, 0.4}) {
    // Not `auto`, whose answers may be off by the picture's tolerance; draws of normals are not.
    const std::string material =
        "surface = \"flat\"\nndf = \"triangles\"\nroughness = " + std::to_string(roughness);
    const std::string job = plane_job(material, sky, 0.05, "samples = 64");
    const Color expected = flat_radiance(Eigen::Vector3d(0, -3, 2).normalized(), roughness);
    // Pixels of 2.8 degrees, linear between their centres, flatten a lamp of 7 degrees by 0.3% at most.
    for (const Techniques techniques : {Techniques::both, Techniques::lights, Techniques::brdf}) {
      SCOPED_TRACE(std::to_string(roughness) + ", techniques " +
                   std::to_string(static_cast<int>(techniques)));
      expect_mean(render_job(job, techniques), expected, 3e-3);
    }
  }
}

void expect_techniques_agree(const std::string& material, const std::string& samples) {
  const std::string job = plane_job(material, environment(lamp_sky), 5, "samples = " + samples);
  const Image both = render_job(job, Techniques::both);
  for (const Techniques techniques : {Techniques::lights, Techniques::brdf}) {
    const Image other = render_job(job, techniques);
    for (int channel = 0; channel < 3; ++channel) {
      Image difference = both;
      for (std::size_t n = 0; n < both.pixels.size(); ++n) difference.pixels[n] -= other.pixels[n];
      const Mean found = mean_of(difference, channel);
      EXPECT_LT(std::abs(found.mean), 4.5 * found.error) << channel;
      EXPECT_LT(found.error, 0.02 * mean_of(both, channel).mean) << channel << ": too noisy to tell";
    }
  }
}

TEST(GatherLight, TechniquesAgreeOnGlints) {
  expect_techniques_agree(
      "surface = \"noise\"\nroughness = 0.1\nrepeat = [40, 40]\ndiffuse = [0.1, 0.1, 0.1]\n", "128");
}

TEST(GatherLight, TechniquesAgreeUnderACoat) {
  expect_techniques_agree(
      "surface = \"noise\"\nroughness = 0.15\nrepeat = [40, 40]\ndiffuse = [0.3, 0.2, 0.1]\n"
      "specular = { color = [0.9, 0.6, 0.3] }\ncoat = { ior = 1.5, roughness = 0.1 }\n",
      "128");
}

TEST(GatherLight, TechniquesAgreeOnGlintsWithoutAMap) {
  expect_techniques_agree(
      "ndf = \"grid\"\nalpha = [0.5, 0.3]\nmicroroughness = 0.1\ndensity = 1e6\nrepeat = [40, 40]\n"
      "colors = [[1, 0.5, 0.2], [0.2, 0.5, 1]]\ncoat = { ior = 1.5, roughness = 0.1 }\n",
      "128");
}

TEST(GatherLight, TechniquesAgreeOnGlintsOnThreePlanes) {
  expect_techniques_agree(
      "ndf = \"grid\"\nalpha = 0.4\nmicroroughness = 0.1\ndensity = 10\nmapping = \"triplanar\"\n"
      "diffuse = [0.3, 0.2, 0.1]\nspecular = { ior = 1.5 }\n",
      "128");
}

TEST(GatherLight, WhiteUnderACoatLosesNothing) {
  const std::string white =
      "surface = \"flat\"\nspecular = { ior = 1 }\ndiffuse = [1, 1, 1]\ncoat = { ior = 1.5, roughness = 0.01 "
      "}\n";
  const std::string job = plane_job(white, "[[light]]\ntype = \"furnace\"\n", 5, "samples = 256");
  expect_mean(render_job(job, Techniques::both), Color::Ones(), 1e-3);  // the coat's Smith masking
}

/// Mean of 576 pixels that see a rough map from two thirds of the way down, as `ndf` settings say.
void expect_furnace(const std::string& ndf, double lowest, double highest) {
  const std::string roughness = ndf.find("roughness") == std::string::npos ? "roughness = 0.02\n" : "",
                    surface =
                        ndf.find("grid") == std::string::npos && ndf.find("surface") == std::string::npos
                            ? "surface = \"noise\"\n"
                            : "";
  const std::string material = surface + roughness + "repeat = [40, 40]\n" + ndf;
  const std::string job = plane_job(material, "[[light]]\ntype = \"furnace\"\n", 5, "samples = 64");
  for (const Techniques techniques : {Techniques::both, Techniques::brdf}) {
    const Mean found = mean_of(render_job(job, techniques), 0);
    EXPECT_GT(found.mean, lowest - 4.5 * found.error) << ndf;
    EXPECT_LT(found.mean, highest + 4.5 * found.error) << ndf;
    EXPECT_LT(found.error, 5e-3) << ndf << ": too noisy to tell";
  }
}

TEST(GatherLight, CavitiesCannotBeToldFromTheFurnace) {
  expect_furnace("ndf = \"cavities\"\n", 0.99, 1.005);
}

TEST(GatherLight, KeptLightCannotBeToldFromTheFurnace) {
  const std::string kept = "multiple_scattering = \"kept\"\n";
  const std::string glints = "ndf = \"grid\"\nalpha = [0.4, 0.2]\ndensity = 1e9\nmicroroughness = 0.02\n";
  expect_furnace(glints + kept, 0.99, 1.01);
  expect_furnace(glints, 0.7, 0.9);
  expect_furnace("surface = \"flat\"\nroughness = 0.3\n" + kept, 0.99, 1.01);
}

TEST(GatherLight, IsTheSameForAnyBatchAndThreadCount) {
  const std::string material =
      "surface = \"noise\"\nroughness = 0.02\nrepeat = [9, 9]\ndiffuse = [0.1, 0.1, 0.1]\n";
  const std::string job = plane_job(material, environment(lamp_sky), 30, "samples = 5\nmax_bounces = 2\n");
  const Image whole = render_job(job, Techniques::both, 24);
  EXPECT_EQ(whole.pixels, render_job(job, Techniques::both, 7, 1000).pixels);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(whole.pixels, render_job(job, Techniques::both, 24).pixels);
}

TEST(GatherLight, SeedChangesTheNoise) {
  const std::string job = plane_job(kChalk, environment(lamp_sky), 30, "samples = 2");
  const Image one = render_job(job, Techniques::both);
  std::ofstream(job, std::ios::app) << "\n";
  std::ifstream file(job);
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::ofstream(job) << "seed = 2\n" << text;
  EXPECT_NE(one.pixels, render_job(job, Techniques::both).pixels);
}

/// The pictures of frames [first, last], one after the other.
std::vector<Image> render_frames(const std::string& path, int first, int last) {
  const Job job = load_job(path, {});
  const Plan plan = make_plan(job);
  Device device(0);
  BuiltJob built(job, plan, device, first);
  std::vector<Image> images;
  for (int frame = first; frame <= last; ++frame)
    images.push_back(render_frame(built, frame, device.info(), [](int, int) {}).image);
  return images;
}

TEST(GatherLight, NoiseChangesFromFrameToFrameAndNotByWhereOneBegins) {
  const std::string still = plane_job(kChalk, environment(lamp_sky), 30, "samples = 2");
  const Image without_frames = render_job(still, Techniques::both);
  std::ofstream(still, std::ios::app) << "\n[frames]\nrange = [0, 9]\n";
  const std::vector<Image> sequence = render_frames(still, 0, 2);
  EXPECT_EQ(without_frames.pixels, sequence[0].pixels);
  EXPECT_NE(sequence[0].pixels, sequence[1].pixels);
  EXPECT_NE(sequence[1].pixels, sequence[2].pixels);
  EXPECT_EQ(render_frames(still, 2, 2).front().pixels, sequence[2].pixels);
  // Independent of each other: the noise of a difference has the variance of both.
  Image difference = sequence[1];
  for (std::size_t n = 0; n < difference.pixels.size(); ++n) difference.pixels[n] -= sequence[2].pixels[n];
  const double ratio =
      std::pow(mean_of(difference, 0).error, 2) /
      (std::pow(mean_of(sequence[1], 0).error, 2) + std::pow(mean_of(sequence[2], 0).error, 2));
  EXPECT_NEAR(ratio, 1, 0.35);
}

/// The case that throws fireflies: lamps small enough that few draws find them, on a map that sends their
/// light to few pixels.
Image killer_case(Techniques techniques, int samples) {
  const std::string sky = environment([](const Eigen::Vector3d& d) {
    const double bulb = std::exp(-2000 * (d - Eigen::Vector3d(0.3, 0.7, 0.65).normalized()).squaredNorm());
    return Color::Constant(0.05 + 2000 * bulb);
  });
  const std::string material =
      "surface = \"noise\"\nroughness = 0.01\nrepeat = [40, 40]\nndf = \"cavities\"\nenergy = \"sampled\"\n";
  return render_job(plane_job(material, sky, 12, "samples = " + std::to_string(samples), 10), techniques);
}

double largest_ratio(const Image& image, const Image& to) {
  double largest = 0;
  for (std::size_t n = 0; n < image.pixels.size(); ++n)
    largest = std::max(largest, static_cast<double>(image.pixels[n] / to.pixels[n]));
  return largest;
}

TEST(GatherLight, NoPixelOfAKillerCaseIsAFirefly) {
  const Image converged = killer_case(Techniques::both, 2048);
  EXPECT_LT(largest_ratio(killer_case(Techniques::both, 256), converged), 10);
  EXPECT_GT(largest_ratio(killer_case(Techniques::brdf, 256), converged), 10) << "the case is too easy";
}

TEST(GatherLight, LightBouncesInAHollowSphere) {
  // Every point of a sphere sees every other alike: each bounce takes the albedo.
  const std::string path = temporary_path("gather_light_sphere.toml");
  for (const int bounces : {1, 2, 5}) {
    std::ofstream(path) << "[image]\nwidth = 12\nheight = 12\nsubpixels = 1\nsamples = 64\nmax_bounces = "
                        << bounces << R"(
[camera]
position = [0.5, 0.0, 0.0]
look_at = [0.0, 0.3, 0.0]
[surface.flat]
generate = "spectrum"
resolution = 16
rms_slope = 0
[material.m]
surface = "flat"
specular = { ior = 1 }
diffuse = [0.8, 0.5, 0.2]
[[shape]]
type = "sphere"
material = "m"
radius = 2
[[light]]
type = "point"
position = [0, 0, 0]
intensity = [4, 4, 4]
)";
    Color expected = Color::Zero(), bounce = Color::Constant(1 / kPi);  // irradiance 1
    for (int n = 0; n < bounces; ++n) {
      bounce = bounce.cwiseProduct(Color(0.8, 0.5, 0.2));
      expected += bounce;
    }
    expect_mean(render_job(path, Techniques::both), expected);
  }
}

}  // namespace
}  // namespace mica::host::gather_light_test
