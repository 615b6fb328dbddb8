#pragma once

#include <algorithm>
#include <cstdint>

#include "kernels/types.h"

namespace mica::host {

/// Smallest box around fixed-point normals; empty until something is added.
struct NormalBox {
  std::int64_t s_min = INT64_MAX, s_max = INT64_MIN, t_min = INT64_MAX, t_max = INT64_MIN;

  bool empty() const { return s_min > s_max; }
  void add(std::int64_t s, std::int64_t t) {
    s_min = std::min(s_min, s), s_max = std::max(s_max, s);
    t_min = std::min(t_min, t), t_max = std::max(t_max, t);
  }
  void add(const NormalBox& other) {
    if (other.empty()) return;
    add(other.s_min, other.t_min);
    add(other.s_max, other.t_max);
  }
};

/// Writes a child's bounds into a node, rounded outwards. A child without normals gets an empty box.
inline void store(const NormalBox& box, int child, std::int16_t* node) {
  if (box.empty()) {
    node[child] = node[child + 32] = INT16_MAX;
    node[child + 16] = node[child + 48] = INT16_MIN;
    return;
  }
  using namespace device_types;
  static_assert(MICA_NORMAL_ONE == 1 << 30);
  const auto floor16 = [](std::int64_t n) {
    return static_cast<std::int16_t>(
        std::clamp<std::int64_t>((n * MICA_BOUND_ONE) >> 30, INT16_MIN, INT16_MAX));
  };
  const auto ceil16 = [](std::int64_t n) {
    return static_cast<std::int16_t>(
        std::clamp<std::int64_t>(-((-n * MICA_BOUND_ONE) >> 30), INT16_MIN, INT16_MAX));
  };
  node[child] = floor16(box.s_min), node[child + 16] = ceil16(box.s_max);
  node[child + 32] = floor16(box.t_min), node[child + 48] = ceil16(box.t_max);
}

}  // namespace mica::host
