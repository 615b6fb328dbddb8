// The pictures of docs/accuracy.md: a crop of a scratched sphere by every mixture, by `triangles`, and by
// brute force with 65,536 point samples a pixel. The same footprints and weights for all: what differs is D.
//   scratched_sphere FOLDER        writes FOLDER/NAME.png and prints times and errors

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "host/base/stopwatch.h"
#include "host/device/device.h"
#include "host/image/image.h"
#include "host/measure/point_samples.h"
#include "host/methods/evaluator.h"
#include "host/methods/registry.h"
#include "host/render/film.h"
#include "host/scene/scene.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr int kSide = 84, kZoom = 3;  // pixels, and how often each is shown
constexpr std::int64_t kSamples = 65536;
constexpr int kFewer = 16;         // samples of the picture that tells the noise
constexpr double kExposure = 0.5;  // stops
constexpr int kRepeats = 5;

SceneDescription sphere_scene() {
  SceneDescription scene;
  scene.camera.position = {0, -4, 0.6}, scene.camera.look_at = {0.2, -0.8, 0.42};
  scene.camera.fov_degrees = 11;
  MaterialDescription material;
  material.name = "metal", material.surface = "scratches", material.repeat = {12, 6};
  material.roughness = 0.01;
  material.specular = ConductorFresnel{};
  scene.materials = {material};
  scene.shapes = {{SphereShape{}, "metal"}};
  PointLight light;
  light.position = {2.2, -4.5, 3.0}, light.intensity = {20, 20, 20};
  scene.lights = {light};
  return scene;
}

Surface scratched() {
  ScratchesSurface scratches;
  scratches.resolution = 1024;
  scratches.density = 0.6;
  return make_surface({"scratches", scratches, Interpolation::bilinear}, nullptr);
}

Image image_of(const TracedRows& rows, const std::vector<float>& densities) {
  Film film(kSide, kSide, {"R", "G", "B"});
  film.add(rows, densities);
  return film.take();
}

void write_zoomed(const std::string& path, const Image& image) {
  Image zoomed{kSide * kZoom, kSide * kZoom, image.channels, {}, {}};
  for (int y = 0; y < zoomed.height; ++y)
    for (int x = 0; x < zoomed.width; ++x)
      for (int c = 0; c < 3; ++c)
        zoomed.pixels.push_back(image.pixels[3 * ((y / kZoom) * kSide + x / kZoom) + c]);
  write_png(path, zoomed, kExposure);
}

double relative_l2(const Image& image, const Image& reference) {
  double squares = 0, all = 0;
  for (std::size_t n = 0; n < image.pixels.size(); ++n) {
    squares += std::pow(image.pixels[n] - reference.pixels[n], 2);
    all += std::pow(reference.pixels[n], 2);
  }
  return std::sqrt(squares / all);
}

void run(const std::string& folder) {
  const Surface surface = scratched();
  const Scene scene(sphere_scene(), kSide, kSide, 1, {0.3});
  const TracedRows rows = scene.trace(0, kSide);
  std::vector<Query> queries;
  for (const GlintQuery& glint : rows.queries) queries.push_back(glint.query);

  const Stopwatch sampling;
  const Image truth = image_of(rows, point_samples(surface, queries, kSamples, 1));
  const double brute_seconds = sampling.seconds();
  write_zoomed(folder + "/brute_force.png", truth);
  // Fewer samples are off by four times as much: they tell how far brute force itself is off.
  const Image again = image_of(rows, point_samples(surface, queries, kSamples / kFewer, 2));
  fmt::print("{} pixels lit, {} samples each: {:.1f} s, noise {:.2f} %\n", queries.size(), kSamples,
             brute_seconds, 100 * relative_l2(again, truth) / std::sqrt(kFewer + 1.0));

  Device device(0);
  for (const char* const name : {"triangles", "gaussians", "beckmanns", "smooth"}) {
    const auto evaluator = make_evaluator(name, device, surface);
    std::vector<float> densities = evaluator->evaluate(queries);
    std::vector<double> seconds;
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      const Stopwatch watch;
      densities = evaluator->evaluate(queries);
      seconds.push_back(watch.seconds());
    }
    std::sort(seconds.begin(), seconds.end());
    const Image image = image_of(rows, densities);
    write_zoomed(folder + "/" + name + ".png", image);
    fmt::print("{:>12} {:8.3f} s, error {:.2f} %\n", name, seconds[kRepeats / 2],
               100 * relative_l2(image, truth));
  }
}

}  // namespace
}  // namespace mica::host::bench

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: scratched_sphere FOLDER\n");
    return 2;
  }
  try {
    mica::host::bench::run(argv[1]);
    return 0;
  } catch (const mica::Error& error) {
    fmt::print(stderr, "scratched_sphere: {}\n", error.what());
    return 1;
  }
}
