#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/app/command.h"

namespace mica::host::app {

/// What the tests of farms share: a job of six frames that takes a moment, and its log.
class FarmTest : public CommandTest {
 protected:
  FarmTest() {
    write("job.toml",
          R"(image = { width = 12, height = 9, subpixels = 2, filter = "gaussian", aovs = ["ndf"] }
frames = { range = [0, 5] }
camera = { position = [0, -3, 1], keys = [{ frame = 0 }, { frame = 5, position = [1, -3, 1] }] }
surface.bumps = { file = "map.exr", encoding = "signed" }
material.gold = { surface = "bumps", roughness = 0.05 }
shape = [{ type = "sphere", material = "gold" }]
light = [{ type = "point", position = [-2, -2, 3], intensity = [30, 30, 30] }]
audit = { samples = 20 }
)");
    write_map();
  }

  /// Events of a log, without those of phases, progress and kernels.
  std::vector<nlohmann::json> events(const std::string& log) const {
    std::vector<nlohmann::json> found;
    std::istringstream lines(bytes(path(log)));
    for (std::string line; std::getline(lines, line);) {
      const auto event = nlohmann::json::parse(line);
      if (!std::set<std::string>{"phase", "progress", "kernels"}.count(event.at("event")))
        found.push_back(event);
    }
    return found;
  }
  /// "started finished failed"
  std::string words(const std::string& log) const {
    std::string all;
    for (const auto& event : events(log))
      all += (all.empty() ? "" : " ") + event.at("event").get<std::string>();
    return all;
  }
  void change(const std::string& file, std::size_t place) const {
    std::string content = bytes(path(file));
    content.at(place) = static_cast<char>(content[place] ^ 0x20);
    write(file, content);
  }
};

}  // namespace mica::host::app
