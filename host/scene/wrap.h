#pragma once

#include <Eigen/Core>

namespace mica::host {

/// To [0, 1); of a tiny negative number, 1 - x would round to 1.
inline Eigen::Vector2d wrap(const Eigen::Vector2d& uv) {
  const Eigen::Vector2d wrapped = uv - uv.array().floor().matrix();
  return (wrapped.array() < 1).select(wrapped, 0);
}

}  // namespace mica::host
