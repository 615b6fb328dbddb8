#include "host/measure/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/base/stopwatch.h"
#include "host/measure/image_difference.h"
#include "host/measure/point_samples.h"
#include "host/reference/oracle.h"
#include "host/render/film.h"
#include "host/scene/scene.h"

namespace mica::host::bench {
namespace {

constexpr int kResolution = 512, kSubpixels = 2, kRepeats = 3;
constexpr double kPictureTolerance = 1e-5;
constexpr double kMostSampleSeconds = 2;  // that a picture by brute force may take

/// A part of data/jobs/shell.toml, at the same size of pixels whatever their number.
SceneDescription shell_scene(int height) {
  constexpr double degrees_a_pixel = 0.07;
  SceneDescription scene;
  scene.camera.position = {0, -3.2, 1.4}, scene.camera.look_at = {0.05, 0, 0.42},

  scene.camera.fov_degrees = degrees_a_pixel * height;
  MaterialDescription material;
  material.name = "shell", material.surface = "nacre", material.repeat = {12, 12}, material.roughness = 0.01;
  material.specular = ConductorFresnel{};
  material.diffuse = {0.1, 0.085, 0.07};
  scene.materials = {material};
  scene.shapes = {{ShellShape{}, "shell"}};
  PointLight light;
  light.position = {1.6, -3.6, 3.4}, light.intensity = {26, 25, 24};
  scene.lights = {light};
  scene.background.color = {0.012, 0.014, 0.02};
  return scene;
}

/// What all pictures have in common.
struct Crop {
  Surface surface;
  int width, height;
  TracedRows rows;
  std::vector<Query> queries;

  Image image_of(const std::vector<float>& densities) const {
    Film film(width, height, {"R", "G", "B"});
    film.add(rows, densities);
    return film.take();
  }
};

Crop trace_crop(int width) {
  SpectrumSurface nacre;
  nacre.resolution = kResolution, nacre.rms_slope = 0.3;
  const int height = width * 3 / 4;
  const Scene scene(shell_scene(height), width, height, kSubpixels);
  Crop crop{make_surface({"nacre", nacre, Interpolation::bilinear}, nullptr),
            width,
            height,
            scene.trace(0, height),
            {}};
  for (const GlintQuery& glint : crop.rows.queries) crop.queries.push_back(glint.query);
  return crop;
}

Picture judged(Picture picture, const Image& reference) {
  const DisplayDifference difference = display_difference(picture.image, reference);
  picture.relative_mse = relative_mse(picture.image, reference);
  picture.delta_e_mean = difference.mean, picture.delta_e_percentile_95 = difference.percentile_95;
  return picture;
}

/// Brute force: how long a sample takes, and what its error is worth.
class BruteForce {
 public:
  BruteForce(const Crop& crop, const Image& reference) : crop_(crop), reference_(reference) {
    constexpr std::int64_t calibration = 64;
    const Picture picture = with_samples(calibration);
    seconds_a_sample_ = picture.seconds / calibration;
    variance_ = picture.relative_mse * calibration;  // an unbiased estimate's error falls as 1 / samples
  }

  Picture with_samples(std::int64_t samples) const {
    const Stopwatch watch;
    const std::vector<float> densities = point_samples(crop_.surface, crop_.queries, samples, 1);
    const double seconds = watch.seconds();
    Picture picture{"brute force", fmt::format("brute force, {} samples", samples), crop_.image_of(densities),
                    seconds, static_cast<double>(samples)};
    return judged(std::move(picture), reference_);
  }

  PictureRow beside(Picture evaluator) const {
    PictureRow row;
    row.equal_time = with_samples(affordable(evaluator.seconds / seconds_a_sample_));
    row.equal_error_samples = variance_ / std::max(evaluator.relative_mse, 1e-30);
    row.equal_error_seconds = row.equal_error_samples * seconds_a_sample_;
    row.equal_error_capped = row.equal_error_seconds > kMostSampleSeconds;
    row.equal_error = with_samples(affordable(row.equal_error_samples));
    row.evaluator = std::move(evaluator);
    return row;
  }

 private:
  std::int64_t affordable(double samples) const {
    return std::max<std::int64_t>(std::llround(std::min(samples, kMostSampleSeconds / seconds_a_sample_)), 1);
  }

  const Crop& crop_;
  const Image& reference_;
  double seconds_a_sample_ = 0, variance_ = 0;
};

Picture render_with(const Prepared& prepared, const Crop& crop) {
  const std::vector<float> densities = prepared.evaluator->evaluate(crop.queries);  // warm-up
  std::vector<double> seconds;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const Stopwatch watch;
    prepared.evaluator->evaluate(crop.queries);
    seconds.push_back(watch.seconds());
  }
  std::sort(seconds.begin(), seconds.end());
  return {prepared.contender.evaluator, prepared.contender.label, crop.image_of(densities),
          seconds[seconds.size() / 2]};
}

}  // namespace

void render_pictures(int width, const std::vector<Contender>& contenders, Device& device,
                     const Progress& progress, Results* results) {
  progress("picture: reference");
  const Crop crop = trace_crop(width);
  std::vector<float> references;
  for (const reference::OracleResult& result :
       reference::Oracle(crop.surface, kPictureTolerance).evaluate(crop.queries))
    references.push_back(static_cast<float>(result.density));
  results->reference_picture = crop.image_of(references);
  results->picture_text = fmt::format(
      "{} x {} pixels of a metal shell with a random bumpy normal map of {}² texels, roughness 0.01, {} "
      "footprints "
      "a pixel, {} queries in all",
      crop.width, crop.height, kResolution, kSubpixels * kSubpixels, crop.queries.size());

  progress("picture: brute force");
  const BruteForce brute_force(crop, results->reference_picture);
  for (const Prepared& prepared : prepare(contenders, device, crop.surface)) {
    progress("picture: " + prepared.contender.label);
    if (prepared.evaluator)
      results->pictures.push_back(
          brute_force.beside(judged(render_with(prepared, crop), results->reference_picture)));
  }
}

}  // namespace mica::host::bench
