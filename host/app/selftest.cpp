// mica selftest: is this device's arithmetic what the kernels count on, and do they keep what they promise on
// it?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/app/commands.h"
#include "host/app/device_option.h"
#include "host/app/exit_code.h"
#include "host/app/json_file.h"
#include "host/app/output.h"
#include "host/app/selftest_tables.h"
#include "host/base/interrupt.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/standard.h"
#include "host/reference/gaussian_mixture.h"
#include "host/surface/texel_footprint.h"
#include "host/verify/accuracy.h"
#include "host/verify/device_checks.h"
#include "host/verify/grid_checks.h"
#include "host/verify/pyramid_checks.h"

namespace mica::host::app {
namespace {

constexpr int kResolution = 256;

struct TestSurface {
  std::string name;
  Surface surface;
};

template <typename Kind>
Surface synthesised(const Kind& source, Interpolation interpolation) {
  return make_surface({"selftest", source, interpolation}, nullptr);
}

/// s rises by `rise` across the map, t is constant.
Surface ramp(double rise) {
  std::vector<Eigen::Vector2d> normals;
  for (int n = 0; n < kResolution * kResolution; ++n)
    normals.emplace_back(rise * ((n % kResolution + 0.5) / kResolution - 0.5), 0.1);
  return Surface(kResolution, kResolution, Interpolation::bilinear, std::move(normals));
}

std::vector<TestSurface> test_surfaces() {
  SpectrumSurface spectrum;
  spectrum.resolution = kResolution;
  FlakesSurface flakes;
  flakes.resolution = kResolution;
  return {{"spectrum, bilinear", synthesised(spectrum, Interpolation::bilinear)},
          {"spectrum, bicubic", synthesised(spectrum, Interpolation::bicubic)},
          {"flakes, nearest", synthesised(flakes, Interpolation::nearest)},
          {"flakes, bilinear", synthesised(flakes, Interpolation::bilinear)},
          {"flat", ramp(0)},
          {"ramp", ramp(0.8)}};
}

/// Footprints from 0.2 to 12 texels, round and thin, eight half vectors each.
std::vector<std::vector<Query>> probes(const Surface& surface, double roughness) {
  constexpr int sizes = 6;
  std::vector<std::vector<Query>> all;
  for (int size = 0; size < sizes; ++size) {
    const double major_texels = 0.2 * std::pow(60, size / (sizes - 1.0));
    for (const double aspect : {1.0, 10.0}) {
      const Eigen::Vector2d mean_uv(0.13 + 0.37 * size, 0.71 + 0.11 * aspect);
      const Footprint footprint =
          make_footprint(surface, mean_uv, major_texels, major_texels / aspect, 0.4 * size);
      all.push_back(probe(surface, footprint, roughness, 8, static_cast<std::uint64_t>(size)));
    }
  }
  return all;
}

/// A method that promises to be the map's own density.
std::vector<Check> check_promise(const Method& method, Device* device) {
  std::vector<Check> checks;
  for (const TestSurface& test : test_surfaces()) {
    if (!method.takes(test.surface.interpolation())) continue;
    const reference::Oracle oracle(test.surface, 1e-7);
    const std::unique_ptr<MethodSettings> settings = method.settings();
    const std::unique_ptr<Standard> standard = method.standard(&test.surface, &oracle, *settings);
    if (!standard || !standard->is_the_map()) return {};
    const std::unique_ptr<Evaluator> evaluator = method.make(device, &test.surface, *settings);
    for (const double roughness : {1e-4, 1e-3, 1e-2, 0.1}) {
      check_interrupt();
      const Accuracy accuracy =
          compare(evaluator.get(), *standard, test.surface, probes(test.surface, roughness));
      checks.push_back({fmt::format("{}: {}, roughness {}", method.name(), test.name, roughness),
                        accuracy.queries, accuracy.worst});
    }
  }
  return checks;
}

/// A mixture's promise is to be its own sum; how far that is from the map depends on the map.
std::vector<Check> check_gaussians(Device* device) {
  MixtureSettings settings;
  settings.cutoff_error = 1e-6;  // the arithmetic is to be seen, not what the default culls
  std::vector<Check> checks;
  for (const TestSurface& test : test_surfaces()) {
    if (test.surface.interpolation() == Interpolation::bicubic) continue;
    GaussianEvaluator evaluator(*device, test.surface, settings);
    const reference::GaussianMixture mixture(test.surface, 1);
    for (const double roughness : {1e-3, 1e-2, 0.1}) {
      Check check{fmt::format("gaussians: {}, roughness {}", test.name, roughness), 0, 0};
      for (const std::vector<Query>& queries : probes(test.surface, roughness)) {
        check_interrupt();
        const std::vector<float> densities = evaluator.evaluate(queries);
        const std::vector<double> expected = mixture.evaluate(queries);
        const double peak = *std::max_element(expected.begin(), expected.end());
        check.points += queries.size();
        for (std::size_t n = 0; n < queries.size(); ++n)
          check.worst = std::max(check.worst,
                                 std::abs(densities[n] - expected[n]) / (1e-4 * expected[n] + 2e-5 * peak));
      }
      checks.push_back(check);
    }
  }
  return checks;
}

std::string verdict(const Check& check) {
  if (!check.skipped.empty()) return "not available";
  return check.passed() ? "PASS" : "FAIL";
}

nlohmann::json to_json(const std::vector<Check>& checks) {
  nlohmann::json list = nlohmann::json::array();
  for (const Check& check : checks) {
    nlohmann::json entry = {{"name", check.name}, {"points", check.points}, {"verdict", verdict(check)}};
    entry["worst"] = std::isfinite(check.worst) ? nlohmann::json(check.worst) : nlohmann::json();
    if (!check.skipped.empty()) entry["reason"] = check.skipped;
    list.push_back(entry);
  }
  return list;
}

int run(const DeviceOption& option, const std::string& waves, double evaluations,
        const std::string& json_path, const MethodRegistry& methods) {
  const Outputs outputs({json_path});
  const int device_index = option.index();
  Device device(device_index, parse_word<WaveForm>(waves));
  fmt::print("device {}: {}, {}, waves as {}\n\n", device_index, device.info().name, device.info().version,
             word_of(device.wave_form()));
  fmt::print("{:<48} {:>8} {:>14}\n", "check", "points", "error/allowed");
  std::vector<Check> checks;
  const auto take = [&checks](const std::vector<Check>& more) {
    for (const Check& check : more)
      fmt::print("{:<48} {:>8} {:>14.3f} {}\n", check.name, check.points, check.worst, verdict(check));
    checks.insert(checks.end(), more.begin(), more.end());
  };
  take({check_struct_layout(&device)});
  const std::vector<FunctionError> arithmetic = measure_arithmetic(&device);
  take(arithmetic_checks(arithmetic));
  take(check_special_functions(&device));
  for (const auto& method : methods.all())
    if (method->traits().compared && method->traits().map) take(check_promise(*method, &device));
  take(check_gaussians(&device));
  take(check_pyramid(&device));
  take(check_grid(&device));

  print_arithmetic(arithmetic);
  const std::vector<HardResult> hard =
      print_hard_cases(&device, static_cast<std::uint64_t>(evaluations), methods);

  const std::vector<HardAnswers> answers =
      print_hard_answers(&device, static_cast<std::uint64_t>(evaluations / 100), methods);

  const bool failed =
      std::any_of(answers.begin(), answers.end(), [](const HardAnswers& a) { return a.wrong > 0; }) ||
      std::any_of(checks.begin(), checks.end(), [](const Check& check) { return check.failed(); }) ||
      std::any_of(hard.begin(), hard.end(), [](const HardResult& r) { return r.outcome == Outcome::broken; });
  fmt::print("\n{}\n", failed ? "FAIL: do not trust this device with this driver" : "PASS");
  if (!json_path.empty())
    write_json(json_path, {{"command", "selftest"},
                           {"device", describe_device(device.info())},
                           {"waves", word_of(device.wave_form())},
                           {"checks", to_json(checks)},
                           {"arithmetic", arithmetic_json(arithmetic)},
                           {"hard_cases", hard_cases_json(hard)},
                           {"hard_answers", hard_answers_json(answers)},
                           {"pass", !failed}});
  return static_cast<int>(failed ? ExitCode::device : ExitCode::done);
}

}  // namespace

void add_selftest(CommandLine& app, Command* chosen, const MethodRegistry& methods) {
  auto device = std::make_shared<DeviceOption>();
  auto json_path = std::make_shared<std::string>();
  auto evaluations = std::make_shared<double>(0);
  auto waves = std::make_shared<std::string>();
  CommandLine* command =
      app.add_subcommand("selftest", "Checks the accuracy of a device's arithmetic and of every kernel");
  command->footer(
      "Errors are in units of what is allowed; above 1 a check fails, and the exit code is 3. Densities are\n"
      "compared with the reference in double precision: allowed are 1e-4 of it (1e-3 at roughness 1e-4) "
      "plus\n"
      "1e-6 of the footprint's peak; gaussians, culled at 1e-6, of the mixture's own sum: 1e-4 plus 2e-5 of\n"
      "the peak; grid, of its definition: 1e-4 plus 1e-6 of the smooth distribution, and 5e-4 for the "
      "density\n"
      "of its draws.");
  add_device_option(command, device.get());
  command->add_option("--waves", *waves, "Kernels in this form of a wave; default: what suits the device")
      .type_name("NAME")
      .check(one_of(list_words<WaveForm>()));
  command->add_option("--json", *json_path, "Writes the checks as JSON").type_name("FILE");
  command
      ->add_option(
          "--evaluations", *evaluations,
          "Asks the hard cases on, until so many answers were looked at, and each method a hundredth of "
          "that at random: 1e8 takes two hours or so")
      .type_name("N")
      .check(between(0.0, 1e12));
  command->callback([=, &methods] {
    *chosen = [=, &methods] { return run(*device, *waves, *evaluations, *json_path, methods); };
  });
}

}  // namespace mica::host::app
