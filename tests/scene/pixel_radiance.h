#pragma once

#include <vector>

#include "host/scene/scene.h"

namespace mica::host {

/// What pixels show of what needs no P-NDF.
inline std::vector<Eigen::Vector3f> pixel_radiance(const TracedRows& rows) {
  std::vector<Eigen::Vector3d> pixels, samples;
  for (const Eigen::Vector3f& pixel : rows.radiance) pixels.push_back(pixel.cast<double>());
  for (const Eigen::Vector3f& sample : rows.sample_radiance) samples.push_back(sample.cast<double>());
  add_samples(rows, samples, &pixels);
  std::vector<Eigen::Vector3f> result;
  for (const Eigen::Vector3d& pixel : pixels) result.push_back(pixel.cast<float>());
  return result;
}

}  // namespace mica::host
