#include "host/scene/aovs.h"

#include <algorithm>

namespace mica::host {
namespace {

float a_query(const AovPixel& p, double sum) {
  return static_cast<float>(sum / std::max<int>(p.rows.query_count[p.pixel], 1));
}

}  // namespace

const std::vector<Aov>& aovs() {
  static const std::vector<Aov> all = {
      {"ndf", {"Y"}, [](const AovPixel& p, float* out) { *out = a_query(p, p.density_sum); }},
      {"uv",
       {"U", "V"},
       [](const AovPixel& p, float* out) {
         out[0] = p.rows.uv[p.pixel].x(), out[1] = p.rows.uv[p.pixel].y();
       }},
      {"footprint",
       {"CUU", "CUV", "CVV"},
       [](const AovPixel& p, float* out) { Eigen::Map<Eigen::Vector3f>{out} = p.rows.footprint[p.pixel]; }},
      {"normal",
       {"X", "Y", "Z"},
       [](const AovPixel& p, float* out) { Eigen::Map<Eigen::Vector3f>{out} = p.rows.normal[p.pixel]; }},
      {"queries",
       {"Y"},
       [](const AovPixel& p, float* out) { *out = static_cast<float>(p.rows.query_count[p.pixel]); }},
      {"error", {"Y"}, [](const AovPixel& p, float* out) { *out = static_cast<float>(p.error); }}};
  return all;
}

std::vector<std::string> channels_of(const std::vector<std::string>& words) {
  std::vector<std::string> channels = {"R", "G", "B"};
  for (const Aov& aov : aovs()) {
    if (std::find(words.begin(), words.end(), aov.word) == words.end()) continue;
    for (std::size_t part = 0; part < aov.parts.size(); ++part) channels.push_back(aov.channel(part));
  }
  return channels;
}

}  // namespace mica::host
