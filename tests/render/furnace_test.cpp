// White planes in a white furnace, by every method and all that its light depends on: what they return, as
// the table of docs/accuracy.md has it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "host/base/constants.h"
#include "host/render/render.h"
#include "tests/temporary_path.h"

namespace mica::host::furnace_test {
namespace {

/// A material, and between what it promises to return of the light. 4.5 standard errors are allowed besides.
struct Material {
  std::string name, keys;
  double least, most;
  bool of_map = true;            ///< else it has glints without one
  double most_over_base = 1.02;  ///< with a white base, or below a coat

  friend void PrintTo(const Material& material, std::ostream* out) { *out << material.name; }
};

/// Four maps of 64 x 64 texels: noise, grooves one way, flakes and scratches.
const std::vector<std::string> kMaps = {
    "{ generate = \"spectrum\", resolution = 64, rms_slope = 0.4, correlation = 6 }",
    "{ generate = \"brushed\", resolution = 64, rms_slope = 0.3, correlation_along = 24, correlation_across "
    "= "
    "4 }",
    "{ generate = \"flakes\", resolution = 64, flake_size = 4, alpha = 0.4 }",
    "{ generate = \"scratches\", resolution = 64, length = 40, density = 0.6, depth = 1 }"};
const std::vector<double> kFootprints = {0.7, 6, 50};  // standard deviation at right angles, texels
const std::vector<double> kPolarDegrees = {0, 45, 70, 85};

/// A job of one frame a polar angle. Each pixel has a footprint and directions of its own.
std::string job_of(const std::string& map, const std::string& keys, double sigma_texels) {
  const int pixels = sigma_texels < 20 ? 7 : 3;  // wide ones see all of the map: they are dear, and alike
  constexpr double distance = 10, pitch = 0.02, size = 1000;
  const double fov = 2 * std::atan(0.5 * pixels * pitch / distance) * 180 / kPi;
  const double repeat = sigma_texels / (0.5 * pitch) * size / 64;  // half a subpixel is a standard deviation
  const std::string path = temporary_path("furnace_test.toml");
  std::ofstream file(path);
  file << "[image]\nfilter = \"subpixels\"\nsubpixels = 1\nsamples = 48\nwidth = " << pixels
       << "\nheight = " << pixels << "\n[frames]\nrange = [0, " << kPolarDegrees.size() - 1
       << "]\n[camera]\nup = [1, 0, 0]\nfov = " << fov << "\nkeys = [";
  for (std::size_t n = 0; n < kPolarDegrees.size(); ++n) {
    const double polar = kPolarDegrees[n] * kPi / 180;
    file << "{ frame = " << n << ", look_at = [0.3, 0.2, 0], position = [0.3, "
         << 0.2 - distance * std::sin(polar) << ", " << distance * std::cos(polar) << "] },\n";
  }
  file << "]\n[surface]\nmap = " << map << "\n[material.m]\nrepeat = [" << repeat << ", " << repeat << "]\n"
       << keys << "\n[[shape]]\ntype = \"plane\"\nmaterial = \"m\"\nsize = " << size
       << "\n[[light]]\ntype = \"furnace\"\n";
  return path;
}

/// Mean of the green channel, and its standard error.
struct Returned {
  double mean, error;
};
Returned mean_of(const Image& image) {
  double sum = 0, squares = 0, count = 0;
  for (std::size_t n = 1; n < image.pixels.size(); n += image.channels.size())
    sum += image.pixels[n], squares += std::pow(image.pixels[n], 2), count += 1;
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(squares / count - mean * mean, 0.0) / (count - 1))};
}

/// One a polar angle.
std::vector<Returned> returned(const std::string& path) {
  const Job job = load_job(path, {});
  const Plan plan = make_plan(job);
  Device device(0);
  BuiltJob built(job, plan, device, 0);
  std::vector<Returned> all;
  for (std::size_t n = 0; n < kPolarDegrees.size(); ++n)
    all.push_back(mean_of(render_frame(built, static_cast<int>(n), device.info(), [](int, int) {}).image));
  return all;
}

/// The extremes of what is seen under some footprints, on some maps.
struct Extremes {
  double least = 1e9, most = 0, error = 0;
};

class Furnace : public testing::TestWithParam<Material> {
 protected:
  /// Looks at the material with further keys, and holds it to what it promises.
  static Extremes look(const std::string& keys, const std::vector<std::string>& maps,
                       const std::vector<double>& footprints) {
    const Material& material = GetParam();
    const std::string own = material.of_map ? "surface = \"map\"\nroughness = 0.1\n" : "";
    Extremes extremes;
    for (const std::string& map : maps) {
      for (const double sigma : footprints) {
        const std::vector<Returned> all = returned(job_of(map, own + material.keys + keys, sigma));
        for (std::size_t n = 0; n < all.size(); ++n) {
          extremes.least = std::min(extremes.least, all[n].mean);
          extremes.most = std::max(extremes.most, all[n].mean);
          extremes.error = std::max(extremes.error, all[n].error);
          EXPECT_LE(all[n].mean,
                    (keys.empty() ? material.most : material.most_over_base) + 4.5 * all[n].error)
              << keys << map << ", " << sigma << " texels, " << kPolarDegrees[n] << " degrees";
          EXPECT_TRUE(!keys.empty() || all[n].mean >= material.least - 4.5 * all[n].error)
              << map << ", " << sigma << " texels, " << kPolarDegrees[n] << " degrees: " << all[n].mean;
        }
      }
    }
    return extremes;
  }
};

TEST_P(Furnace, ReturnsWhatItPromises) {
  const Material& material = GetParam();
  const std::string coat = "coat = { ior = 1.5, roughness = 0.02 }\n",
                    white_base = "specular = { ior = 1.5 }\ndiffuse = [1, 1, 1]\n";
  std::string row = "| " + material.name + " |";
  double error = 0;
  const auto add = [&](const Extremes& extremes) {
    row += fmt::format(" {:.3f} to {:.3f} |", extremes.least, extremes.most);
    error = std::max(error, extremes.error);
  };
  const std::vector<std::string> noise = {kMaps[0]};
  add(look("", material.of_map ? kMaps : noise, kFootprints));
  for (const std::string& keys : {coat, white_base, white_base + coat}) add(look(keys, noise, {6}));
  std::printf("%s %.3f |\n", row.c_str(), error);
}

Material on_map(const std::string& name, const std::string& keys, double least, double most) {
  return {name, keys, least, most};
}
/// The base is told what a lobe with the map's moments mirrors: near the horizon a patch mirrors more.
Material of_cavities(const std::string& name, const std::string& keys) {
  return {"`cavities`, " + name, "ndf = \"cavities\"\n" + keys, 0.99, 1.005, true, 1.06};
}
Material of_glints(const std::string& name, const std::string& keys, double least, double most) {
  return {name, "ndf = \"grid\"\nalpha = 0.4\nmicroroughness = 0.05\ndensity = 1e8\n" + keys, least, most,
          false};
}

// P-NDFs and `geometric` masking promise nothing for a patch: they are held to the size of what they gain.
const std::string kKept = "multiple_scattering = \"kept\"\n";
const std::string kBound = "energy_bound = \"patch\"\n";

INSTANTIATE_TEST_SUITE_P(
    Methods, Furnace,
    testing::Values(
        on_map("`triangles`", "", 0.5, 1.3), on_map("`triangles`, kept", kKept, 0.5, 1.3),
        on_map("`gaussians`", "ndf = \"gaussians\"\n", 0.5, 1.3),
        on_map("`gaussians`, kept", "ndf = \"gaussians\"\n" + kKept, 0.5, 1.3),
        on_map("`smooth`", "ndf = \"smooth\"\n", 0.5, 1.3),
        on_map("`smooth`, kept", "ndf = \"smooth\"\n" + kKept, 0.5, 1.3),
        on_map("`pyramid`", "ndf = \"pyramid\"\n", 0.5, 1.3), on_map("`auto`", "ndf = \"auto\"\n", 0.5, 1.3),
        on_map("`normalmap`", "ndf = \"normalmap\"\n", 0, 1.005),
        on_map("`beckmanns`, `exact`", "ndf = \"beckmanns\"\n", 0, 1.005),
        on_map("`beckmanns`, `filtered`", "ndf = \"beckmanns\"\nmasking = \"filtered\"\n", 0.5, 1.02),
        on_map("`beckmanns`, `filtered`, bound", "ndf = \"beckmanns\"\nmasking = \"filtered\"\n" + kBound, 0,
               1.005),
        on_map("`beckmanns`, `geometric`", "ndf = \"beckmanns\"\nmasking = \"geometric\"\n", 0.5, 1.3),
        on_map("`beckmanns`, `geometric`, bound", "ndf = \"beckmanns\"\nmasking = \"geometric\"\n" + kBound,
               0, 1.005),
        of_cavities("`exact`, `diffuse`", ""),
        of_cavities("`exact`, `specular`", "compensation = \"specular\"\n"),
        of_cavities("`sampled`, `diffuse`", "energy = \"sampled\"\n"),
        of_cavities("`sampled`, `specular`", "energy = \"sampled\"\ncompensation = \"specular\"\n"),
        of_glints("`grid`, GGX, Smith", "", 0, 1.005),
        of_glints("`grid`, GGX, Smith, kept", kKept, 0.99, 1.01),
        of_glints("`grid`, GGX, `cavity`", "masking = \"cavity\"\n", 0, 1.005),
        of_glints("`grid`, GGX, `cavity`, kept", "masking = \"cavity\"\n" + kKept, 0.99, 1.01),
        of_glints("`grid`, Beckmann, Smith", "distribution = \"beckmann\"\n", 0, 1.005),
        of_glints("`grid`, Beckmann, Smith, kept", "distribution = \"beckmann\"\n" + kKept, 0.99, 1.01),
        of_glints("`grid`, Beckmann, `cavity`", "distribution = \"beckmann\"\nmasking = \"cavity\"\n", 0,
                  1.005),
        of_glints("`grid`, Beckmann, `cavity`, kept",
                  "distribution = \"beckmann\"\nmasking = \"cavity\"\n" + kKept, 0.99, 1.01)));

}  // namespace
}  // namespace mica::host::furnace_test
