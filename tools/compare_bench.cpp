// Compares a run of `mica bench` with the committed baseline, by ratios that hold on a noisy machine:
//   compare_bench BASELINE.json RUN.json            what got slower or further off; exit code 1 when anything
//   did compare_bench --write BASELINE.json RUN.json    makes the baseline from a run
#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using nlohmann::ordered_json;

// A shared machine moves ratios of medians by a fifth, and shares of peaks that were measured for a moment by
// more.
constexpr double kSpeedTolerance = 1.3, kShareTolerance = 1.6, kErrorTolerance = 1.1, kBytesTolerance = 1.02;

std::string name_of(const ordered_json& measurement) {
  const std::string knob = measurement.at("knob");
  return measurement.at("evaluator").get<std::string>() + (knob.empty() ? "" : " " + knob);
}

std::string name_of_cell(const ordered_json& cell) {
  return fmt::format("{} {}, footprint {}, roughness {}", cell.at("surface").get<std::string>(),
                     cell.at("resolution").get<int>(), cell.at("sigma_texels").get<double>(),
                     cell.at("roughness").get<double>());
}

/// The numbers of a cell that do not depend on the machine's speed: rates over that of the first evaluator,
/// shares of the peak, errors, bytes.
ordered_json ratios_of(const ordered_json& cell) {
  ordered_json ratios;
  for (const ordered_json& m : cell.at("measurements")) {
    if (m.contains("refused")) continue;
    ordered_json& entry = ratios[name_of(m)];
    entry["speed"] = m.at("over_first");
    if (!m.at("share_of_peak").is_null()) entry["share_of_peak"] = m.at("share_of_peak");
    entry["relative_l2"] = m.at("errors").at("relative_l2");
    entry["device_bytes"] = m.at("device_bytes");
  }
  return ratios;
}

ordered_json baseline_of(const ordered_json& run) {
  ordered_json baseline = {{"suite", run.at("suite")},
                           {"speeds_are_over", "the first evaluator of the cell"}};
  for (const char* const group : {"cells", "map_sizes"})
    for (const ordered_json& cell : run.at(group)) baseline["cells"][name_of_cell(cell)] = ratios_of(cell);
  return baseline;
}

/// Prints a line when `now` is worse than `then` by more than a factor; how often it did.
class Comparison {
 public:
  void compare(const std::string& what, const ordered_json& then, const ordered_json& now) {
    check(what + " speed", then, now, "speed", kSpeedTolerance, false);
    check(what + " share of peak", then, now, "share_of_peak", kShareTolerance, false);
    check(what + " relative L2", then, now, "relative_l2", kErrorTolerance, true);
    check(what + " bytes", then, now, "device_bytes", kBytesTolerance, true);
  }
  void missing(const std::string& what) {
    fmt::print("MISSING  {}\n", what);
    ++worse_;
  }
  int worse() const { return worse_; }
  int compared() const { return compared_; }

 private:
  void check(const std::string& what, const ordered_json& then, const ordered_json& now, const char* key,
             double tolerance, bool less_is_better) {
    if (!then.contains(key) || !now.contains(key)) return;
    const double before = then.at(key), after = now.at(key);
    ++compared_;
    const double worse_by = less_is_better ? after / before : before / after;
    if (worse_by > tolerance) {
      fmt::print("WORSE    {}: {:.4g}, was {:.4g}\n", what, after, before);
      ++worse_;
    } else if (worse_by < 1 / tolerance) {
      fmt::print("better   {}: {:.4g}, was {:.4g}\n", what, after, before);
    }
  }

  int worse_ = 0, compared_ = 0;
};

ordered_json read(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot read");
  return ordered_json::parse(file);
}

int compare(const ordered_json& baseline, const ordered_json& now) {
  if (baseline.at("suite") != now.at("suite"))
    throw std::runtime_error(fmt::format("the baseline is of suite {}, the run of {}",
                                         baseline.at("suite").get<std::string>(),
                                         now.at("suite").get<std::string>()));
  Comparison comparison;
  for (const auto& [cell, evaluators] : baseline.at("cells").items()) {
    if (!now.at("cells").contains(cell)) {
      comparison.missing(cell);
      continue;
    }
    for (const auto& [evaluator, ratios] : evaluators.items()) {
      const std::string what = cell + ": " + evaluator;
      if (now.at("cells").at(cell).contains(evaluator))
        comparison.compare(what, ratios, now.at("cells").at(cell).at(evaluator));
      else
        comparison.missing(what);
    }
  }
  fmt::print("{} numbers compared, {} worse or missing\n", comparison.compared(), comparison.worse());
  return comparison.worse() > 0 ? 1 : 0;
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  try {
    if (words.size() == 3 && words[0] == "--write") {
      std::ofstream(words[1]) << baseline_of(read(words[2])).dump(1) << "\n";
      return 0;
    }
    if (words.size() == 2) return compare(read(words[0]), baseline_of(read(words[1])));
  } catch (const std::exception& error) {
    fmt::print(stderr, "compare_bench: {}\n", error.what());
    return 2;
  }
  fmt::print(stderr, "usage: compare_bench [--write] BASELINE.json RUN.json\n");
  return 2;
}
