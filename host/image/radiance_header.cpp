#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "host/image/image_header.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// The numbers of "EXPOSURE=4", or of "COLORCORR= 2 1 0.5".
std::vector<double> numbers_after(const std::string& path, const std::string& line, std::size_t count) {
  std::istringstream text(line.substr(line.find('=') + 1));
  std::vector<double> numbers;
  for (std::string word; text >> word;) {
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(number)) break;
    numbers.push_back(number);
  }
  if (numbers.size() != count)
    throw FileError(fmt::format("{}: found '{}' in its header, expected {} number{} after '='", path,
                                line.substr(0, 60), count, count == 1 ? "" : "s"));
  return numbers;
}

void check_primaries(const std::string& path, const std::string& line) {
  // Radiance's own, and those of Rec. 709.
  constexpr double known[2][8] = {{0.640, 0.330, 0.290, 0.600, 0.150, 0.060, 0.333, 0.333},
                                  {0.640, 0.330, 0.300, 0.600, 0.150, 0.060, 0.3127, 0.3290}};
  const std::vector<double> found = numbers_after(path, line, 8);
  for (const auto& primaries : known) {
    bool same = true;
    for (std::size_t n = 0; n < 8; ++n) same &= std::abs(found[n] - primaries[n]) < 2e-3;
    if (same) return;
  }
  throw FileError(fmt::format("{}: has {}, expected the primaries of Radiance or Rec. 709", path, line));
}

}  // namespace

std::array<double, 3> radiance_exposure(const std::string& path) {
  std::array<double, 3> product{1, 1, 1};
  std::ifstream stream(path, std::ios::binary);
  std::string line;
  for (int n = 0; n < 1000 && std::getline(stream, line) && !line.empty() && line != "\r"; ++n) {
    if (line.back() == '\r') line.pop_back();
    const std::string key = line.substr(0, line.find('='));
    if (key == "FORMAT" && line.find("32-bit_rle_rgbe") == line.npos)
      throw FileError(
          fmt::format("{}: holds pixels in the format {} (XYZE is X, Y, Z); expected 32-bit_rle_rgbe: "
                      "convert it, with ra_xyze -r",
                      path, line.substr(0, 60).substr(std::min<std::size_t>(7, line.size()))));
    if (key == "PRIMARIES") check_primaries(path, line);
    if (key != "EXPOSURE" && key != "COLORCORR") continue;
    std::vector<double> factors = numbers_after(path, line, key == "EXPOSURE" ? 1 : 3);
    for (std::size_t n = 0; n < 3; ++n) {
      const double factor = factors[factors.size() == 1 ? 0 : n];
      if (!(factor > 0)) throw FileError(fmt::format("{}: has {}, expected numbers above 0", path, line));
      product[n] *= factor;
    }
  }
  return product;
}

}  // namespace mica::host
