// mica ndf: one footprint's P-NDF as an image.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "host/app/commands.h"
#include "host/app/device_option.h"
#include "host/app/evaluation.h"
#include "host/app/map_options.h"
#include "host/app/method_options.h"
#include "host/app/ndf_images.h"
#include "host/app/output.h"
#include "host/image/image.h"
#include "host/tables/query_table.h"
#include "mica/error.h"
#include "mica/version.h"

namespace mica::host::app {
namespace {

struct NdfOptions {
  MapOptions map;
  MethodOptions method;
  std::string output, centers;
  std::vector<double> center_uv, sigma, window = {0, 0, 1};
  double roughness = 0;
  int size = 512;
  DeviceOption device;
};

/// The footprint with standard deviations `sigma` = (a) or (a, b, degrees from +u to the axis of a), texels.
Footprint footprint(const NdfOptions& options, const Surface& surface) {
  const double major = options.sigma[0], minor = options.sigma.size() == 3 ? options.sigma[1] : major;
  const double angle = options.sigma.size() == 3 ? options.sigma[2] * M_PI / 180 : 0;
  const Eigen::Vector2d texel_uv(1.0 / surface.width(), 1.0 / surface.height());
  const Eigen::Vector2d a = major * Eigen::Vector2d(std::cos(angle), std::sin(angle)).cwiseProduct(texel_uv);
  const Eigen::Vector2d b = minor * Eigen::Vector2d(-std::sin(angle), std::cos(angle)).cwiseProduct(texel_uv);
  Footprint result;
  if (!options.center_uv.empty()) result.mean_uv = {options.center_uv[0], options.center_uv[1]};
  result.cov_uv = a * a.transpose() + b * b.transpose();
  return result;
}

ImageWindow window_of(const NdfOptions& options) {
  return {{options.window[0], options.window[1]}, options.window[2], options.size};
}

/// Brings the 99.5th percentile of what is positive to 0.8, where the PNG's highlights begin to roll off.
double preview_exposure(std::vector<float> values) {
  constexpr double percentile = 0.995, brightness = 0.8;
  values.erase(std::remove_if(values.begin(), values.end(), [](float value) { return !(value > 0); }),
               values.end());
  if (values.empty()) return 0;
  const auto nth = values.begin() + static_cast<long>(percentile * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return std::log2(brightness / *nth);
}

void check(const NdfOptions& options) {
  if (options.centers.empty() == options.center_uv.empty())
    throw UsageError("expected either --center, for one image, or --centers, for many");
  check_extension(options.output, options.centers.empty() ? std::vector<std::string>{".exr", ".png"}
                                                          : std::vector<std::string>{".npy"});
  if (options.sigma.size() == 2) throw UsageError("--sigma: expected TEXELS or TEXELS,TEXELS,DEGREES");
  for (const double value : options.sigma)
    if (!std::isfinite(value)) throw UsageError("--sigma: expected finite numbers");
  for (const double value : options.window)
    if (!std::isfinite(value)) throw UsageError("--window: expected finite numbers");
  if (!(options.window[2] > 0)) throw UsageError("--window: expected a positive radius");
}

Image evaluate(const NdfOptions& options, const Surface& surface) {
  const ImageWindow window = window_of(options);
  Query query;
  query.footprint = footprint(options, surface);
  query.roughness = options.roughness;
  const std::string problem = method_of(options.method).query_problem(query, &surface);
  if (!problem.empty()) throw UsageError(problem);

  log_precision(surface, query.roughness);
  const OpenEvaluator open =
      open_evaluator(method_of(options.method), *settings_of(options.method), options.device, &surface);
  Image image;
  image.width = image.height = options.size;
  image.channels = {"ndf.Y"};
  image.pixels = draw_with_progress(
      open, 1, [&](std::size_t) { return query; }, window);
  const double share =
      std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) * window.step() * window.step();
  spdlog::info("the pixels hold {:.4g} of the normals (the sum of D over them, times a pixel's area)", share);
  image.metadata = {{"mica:version", version()},
                    {"mica:map", options.map.path},
                    {"mica:interpolation", options.map.interpolation},
                    {"mica:evaluator", open.evaluator->name()},
                    {"mica:device", open.device ? open.device->info().name : "host"},
                    {"mica:center_uv", fmt::format("{}", fmt::join(options.center_uv, ","))},
                    {"mica:sigma_texels", fmt::format("{}", fmt::join(options.sigma, ","))},
                    {"mica:roughness", fmt::format("{}", options.roughness)},
                    {"mica:window", fmt::format("{}", fmt::join(options.window, ","))},
                    {"mica:share_of_normals", fmt::format("{}", share)}};
  return image;
}

/// Images of many footprints that differ in their centre: a row each, pixels from the top left.
int run_centers(const NdfOptions& options) {
  const Table centers = read_query_table(options.centers, {"u", "v", "roughness"});
  SurfaceReport report;
  const Surface surface = load_map(options.map, &report);
  Query query;
  query.footprint = footprint(options, surface);
  const auto footprint_of = [&](std::size_t row) {
    query.footprint.mean_uv = {centers.at(row, 0), centers.at(row, 1)};
    query.roughness = centers.columns > 2 ? centers.at(row, 2) : options.roughness;
    return query;
  };
  check_rows(options.centers, {0, centers.rows}, [&](std::size_t row) {
    return method_of(options.method).query_problem(footprint_of(row), &surface);
  });
  const OpenEvaluator open =
      open_evaluator(method_of(options.method), *settings_of(options.method), options.device, &surface);
  const ImageWindow window = window_of(options);
  const std::vector<float> images = draw_with_progress(open, centers.rows, footprint_of, window);
  write_file_atomically(options.output, to_npy(images, window.count()));
  return 0;
}

int run(const NdfOptions& options) {
  check(options);
  const Outputs outputs({options.output}, {options.map.path, options.centers});
  if (!options.centers.empty()) return run_centers(options);
  SurfaceReport report;
  const Surface surface = load_map(options.map, &report);
  const Image image = evaluate(options, surface);
  if (std::filesystem::path(options.output).extension() == ".exr") {
    write_exr(options.output, image);
  } else {
    const double exposure = preview_exposure(image.pixels);
    write_png(options.output, image, exposure);
    spdlog::info("preview: D = {:.4g} is shown at 80% of the brightest", 0.8 / std::exp2(exposure));
  }
  return 0;
}

/// Numbers joined by commas in one argument.
Option add_numbers(CommandLine* command, const std::string& name, std::vector<double>* numbers, int min,
                   int max, const std::string& description, const std::string& type) {
  return command->add_option(name, *numbers, description).numbers(',', min, max).type_name(type);
}

}  // namespace

void add_ndf(CommandLine& app, Command* chosen, const MethodRegistry& methods) {
  auto options = std::make_shared<NdfOptions>();
  CommandLine* command = app.add_subcommand("ndf", "One footprint's distribution of normals as an image");
  command->footer(
      "The image shows D(s, t), the density of normals over the unit disk: s to the right, t up, 0 outside "
      "the disk.\n"
      "EXR holds D itself in channel ndf.Y. PNG is a preview: the 99.5th percentile of the positive values "
      "is shown\n"
      "at 80%, brighter ones roll off.");
  add_map_options(command, &options->map);
  command->option("--map").required();
  add_numbers(command, "--center", &options->center_uv, 2, 2,
              "Mean of the Gaussian footprint, in map periods: the map is [0,1)^2", "U,V");
  command
      ->add_option("--centers", options->centers,
                   "Many footprints: rows u v [roughness] of a .npy or .csv file; the output is a .npy of a "
                   "row a footprint, its "
                   "pixels from the top left")
      .type_name("FILE");
  add_numbers(command, "--sigma", &options->sigma, 1, 3,
              "Standard deviation of the footprint; or of both axes, and the angle from u to the first",
              "TEXELS[,TEXELS,DEGREES]")
      .required();
  command
      ->add_option("--roughness", options->roughness,
                   "Standard deviation of the intrinsic roughness on the disk, 1e-5 to 1")
      .required()
      .type_name("SIGMA");
  add_method_options(
      command, methods, [](const MethodTraits& traits) { return traits.map && traits.densities; },
      &options->method);
  command->add_option("--size", options->size, "Pixels a side, 1 to 8192")
      .type_name("N")
      .check(between(1, 8192))
      .show_default();
  add_numbers(command, "--window", &options->window, 3, 3,
              "Part of the disk that is shown: its centre and half its side", "S,T,RADIUS");
  command->add_option("-o,--output", options->output, "The image, .exr or .png; with --centers .npy")
      .required()
      .type_name("FILE");
  add_device_option(command, &options->device);
  command->callback([options, chosen] { *chosen = [options] { return run(*options); }; });
}

}  // namespace mica::host::app
