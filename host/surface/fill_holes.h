#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace mica::host {

/// Fills the texels that are not valid, from the rim of each hole inwards: each with the mean of those of its
/// eight neighbours (periodic) that are valid or were filled a round earlier. At least one texel must be
/// valid.
/// @param values width * height of them; T can be added and divided by a double.
template <typename T>
void fill_holes(int width, int height, std::vector<bool> valid, std::vector<T>& values) {
  std::vector<std::size_t> holes;
  for (std::size_t texel = 0; texel < values.size(); ++texel) {
    if (!valid[texel]) holes.push_back(texel);
  }
  const auto mean_of_neighbours = [&](std::size_t texel, T& mean) {
    const int i = static_cast<int>(texel % width), j = static_cast<int>(texel / width);
    int count = 0;
    T sum{};
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const std::size_t neighbour =
            static_cast<std::size_t>((j + dy + height) % height) * width + (i + dx + width) % width;
        if (!valid[neighbour]) continue;
        sum = count == 0 ? values[neighbour] : T(sum + values[neighbour]);
        ++count;
      }
    }
    if (count > 0) mean = sum / static_cast<double>(count);
    return count > 0;
  };
  while (!holes.empty()) {
    std::vector<std::size_t> filled, remaining;
    for (const std::size_t texel : holes) {
      (mean_of_neighbours(texel, values[texel]) ? filled : remaining).push_back(texel);
    }
    for (const std::size_t texel : filled) valid[texel] = true;
    holes = std::move(remaining);
  }
}

}  // namespace mica::host
