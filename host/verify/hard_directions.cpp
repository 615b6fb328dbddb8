#include "host/verify/hard_directions.h"

#include <fmt/format.h>

#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/methods/patch_brdf.h"
#include "host/surface/texel_footprint.h"
#include "mica/error.h"

namespace mica::host {
namespace {

double random_number(std::uint64_t n, std::uint64_t stream) {
  return random_unit(0xd1, stream, n);
}

Eigen::Vector3d at_cosine(double cosine, double azimuth) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

/// Cosines to the geometric normal, log-uniform, at any azimuth.
std::function<Eigen::Vector3d(std::uint64_t)> cosines(double low, double high, std::uint64_t stream) {
  return [=](std::uint64_t n) {
    const double sign = low < 0 ? -1 : 1;
    const double cosine =
        low == 0 ? 0 : sign * std::abs(low) * std::pow(high / low, random_number(n, stream));
    return at_cosine(cosine, 2 * kPi * random_number(n, stream + 1));
  };
}

std::vector<Surface> surfaces() {
  std::vector<Eigen::Vector2d> rim;
  for (int n = 0; n < 64 * 64; ++n) {
    const int step = n % 64, turn = n / 64;
    const double angle = 2 * kPi * step / 64 + 0.4 * std::sin(2 * kPi * turn / 64.0);
    rim.emplace_back(0.98 * std::cos(angle), 0.98 * std::sin(angle));
  }
  return {make_surface({"noise", SpectrumSurface{64, 0.3, 8, 3}, Interpolation::bilinear}, nullptr),
          make_surface({"flakes", FlakesSurface{64, 12, 0.3, 5}, Interpolation::nearest}, nullptr),
          Surface(64, 64, Interpolation::bilinear, rim)};
}

BrdfQuery query(const HardDirections& directions, const Surface& surface, std::uint64_t n) {
  const double sigma = 0.3 * std::pow(10, random_number(n, 0));
  return {make_footprint(surface, {random_number(n, 1), random_number(n, 2)}, sigma, 0.5 * sigma,
                         kPi * random_number(n, 3)),
          directions.view(n), directions.light(n), 2e-3 * std::pow(100, random_number(n, 4))};
}

bool within(double value, double high) {
  return value >= 0 && value <= high;  // NaN is not
}

/// What is wrong with the answers to one query, or empty.
std::string fault_of(const BrdfValue& value, const Albedo& albedo, const BrdfSample& sample, bool dark) {
  constexpr double largest = 1e30, largest_weight = 100;
  const double brightest = dark ? 0 : largest;
  if (!within(value.single, brightest) || !within(value.multiple, brightest) || !within(value.pdf, largest))
    return fmt::format("value {} + {}, pdf {}", value.single, value.multiple, value.pdf);
  if (!within(albedo.single, largest) || !within(albedo.lost, 1))
    return fmt::format("energy {}, lost {}", albedo.single, albedo.lost);
  if (!within(sample.pdf, largest) || !within(sample.weight_single, largest_weight) ||
      !within(sample.weight_multiple, largest_weight))
    return fmt::format("a draw of pdf {} and weights {}, {}", sample.pdf, sample.weight_single,
                       sample.weight_multiple);
  if (sample.pdf > 0 && !(std::abs(sample.light.norm() - 1) < 1e-4 && sample.light.z() > 0))
    return fmt::format("a draw in the direction ({}, {}, {})", sample.light.x(), sample.light.y(),
                       sample.light.z());
  return "";
}

/// @param conserves it promises that no patch scatters more than it receives.
void judge_energy(double most, bool conserves, HardResult* result) {
  constexpr double rounding = 0.02;
  if (most <= 1 + rounding || result->outcome == Outcome::broken) return;
  result->outcome = conserves ? Outcome::broken : Outcome::limitation;
  result->worst = std::max(result->worst, most);
  result->reason = fmt::format("scatters up to {:.2f} times what it receives", result->worst);
}

void ask(const HardDirections& directions, const Surface& surface, bool conserves, PatchBrdf* brdf, int count,
         HardResult* result) {
  std::vector<BrdfQuery> queries;
  std::vector<ViewQuery> views;
  std::vector<SampleQuery> draws;
  for (int n = 0; n < count; ++n) {
    const std::uint64_t number = static_cast<std::uint64_t>(n);
    queries.push_back(query(directions, surface, number));
    views.push_back({queries.back().footprint, queries.back().view, queries.back().roughness});
    draws.push_back({views.back(), number});
  }
  const std::vector<BrdfValue> values = brdf->evaluate(queries);
  const std::vector<Albedo> albedos = brdf->energy(views);
  const std::vector<BrdfSample> samples = brdf->sample(draws);
  float most_energy = 0;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    result->evaluated += 3;
    most_energy = std::max(most_energy, albedos[n].single);
    const std::string fault = fault_of(values[n], albedos[n], samples[n], directions.dark);
    if (fault.empty() || result->outcome == Outcome::broken) continue;
    result->outcome = Outcome::broken;
    result->reason =
        fmt::format("{} at view ({}, {}, {}), light ({}, {}, {}), roughness {}", fault, queries[n].view.x(),
                    queries[n].view.y(), queries[n].view.z(), queries[n].light.x(), queries[n].light.y(),
                    queries[n].light.z(), queries[n].roughness);
  }
  judge_energy(most_energy, conserves, result);
}

}  // namespace

const std::vector<HardDirections>& hard_directions() {
  const auto above = cosines(0.1, 1, 10), low = cosines(1e-6, 0.05, 20), below = cosines(-1e-6, -1, 30);
  const auto horizon = cosines(0, 0, 40);
  static const std::vector<HardDirections> all = {
      {"grazing view", "visible areas tend to zero, and so do what they are divided by", low, above},
      {"grazing light", "cosines to 1e-6", above, low},
      {"grazing view and light", "half vectors anywhere, or of no length", low, cosines(1e-6, 0.05, 50)},
      {"view on the horizon", "sees nothing", horizon, above, true},
      {"view from behind", "sees nothing", below, above, true},
      {"light on the horizon", "lights nothing", above, horizon, true},
      {"light from behind", "lights nothing", above, below, true},
      {"light from below, against the view", "their half vector has no length", above,
       [above](std::uint64_t n) { return Eigen::Vector3d(-above(n)); }, true},
      {"mirrored at the geometric normal", "the half vector is the normal itself", above,
       [above](std::uint64_t n) {
         const Eigen::Vector3d view = above(n);
         return Eigen::Vector3d(-view.x(), -view.y(), view.z());
       }}};
  return all;
}

namespace {

/// The method's settings, once for every masking that it knows; each with its name.
std::vector<std::pair<std::string, SettingTexts>> maskings_of(const Method& method) {
  for (const SettingEntry& entry : list_settings(*method.settings())) {
    if (entry.key != "masking") continue;
    std::vector<std::pair<std::string, SettingTexts>> all;
    for (const std::string& word : entry.words)
      all.push_back({fmt::format("{}, {}", method.name(), word), {{"masking", word}}});
    return all;
  }
  return {{method.name(), {}}};
}

}  // namespace

std::vector<HardResult> run_hard_directions(const HardDirections& directions, Device& device, int queries,
                                            const MethodRegistry& methods) {
  std::vector<HardResult> results;
  for (const auto& method : methods.all()) {
    if (!method->traits().lit_by_brdf) continue;
    for (const auto& [label, texts] : maskings_of(*method)) {
      const std::unique_ptr<MethodSettings> settings = method->settings();
      read_settings(texts, settings.get());
      HardResult result;
      result.hard_case = directions.name, result.evaluator = label;
      for (const Surface& surface : surfaces()) {
        try {
          ask(directions, surface, method->conserves_energy(*settings),
              method->make_brdf(&device, &surface, *settings).get(), queries, &result);
        } catch (const UsageError& error) {
          result.outcome = Outcome::refused, result.reason = error.what();
        } catch (const DeviceError& error) {
          result.outcome = Outcome::broken, result.reason = error.what();
        }
      }
      results.push_back(result);
    }
  }
  return results;
}

}  // namespace mica::host
