#include "host/reference/random_numbers.h"

#include <utility>

namespace mica::host::reference {

std::uint32_t random_bits(std::uint64_t key, std::uint32_t dimension) {
  constexpr std::uint64_t multiplier = 0xd256d193;
  constexpr std::uint32_t weyl = 0x9e3779b9;  // 2^32 / the golden ratio
  std::pair<std::uint32_t, std::uint32_t> words(static_cast<std::uint32_t>(key),
                                                static_cast<std::uint32_t>(key >> 32));
  for (std::uint32_t round = 0; round < 10; ++round) {
    const std::uint64_t product = multiplier * words.first;
    const std::uint32_t round_key = dimension / 2 + round * weyl;
    words = {static_cast<std::uint32_t>(product >> 32) ^ round_key ^ words.second,
             static_cast<std::uint32_t>(product)};
  }
  return dimension % 2 == 0 ? words.first : words.second;
}

double random_uniform(std::uint64_t key, std::uint32_t dimension) {
  const std::uint32_t upper = random_bits(key, dimension) / 256;
  return upper / 16777216.0;
}

}  // namespace mica::host::reference
