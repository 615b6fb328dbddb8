#include "host/scene/pixel_probes.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "host/base/random.h"
#include "host/scene/light_samples.h"

namespace mica::host {
namespace {

constexpr std::uint64_t kProbes = 0x70726f6265;  // a stream of random numbers
constexpr int kRing = 1;                         // pixels beyond the reach, whose rays tell of penumbras
constexpr int kFewShadowRays = 2, kManyShadowRays = 6;  // along each side of a lamp

Rectangle<Probe> room_for(const ProbedPixels& pixels, int margin, int more) {
  return {pixels.first_row - margin, pixels.end_row - pixels.first_row + 2 * margin + more,
          pixels.first_column - margin, pixels.end_column - pixels.first_column + 2 * margin + more};
}

/// Calls `visit(down, right)`, in parallel, with the places in half pixels of all centres and corners of
/// pixels and of `margin` more around them.
template <typename Visit>
void everywhere(const ProbedPixels& pixels, int margin, const Visit& visit) {
  tbb::parallel_for(2 * (pixels.first_row - margin), 2 * (pixels.end_row + margin) + 1, [&](int down) {
    const int first = 2 * (pixels.first_column - margin), last = 2 * (pixels.end_column + margin);
    for (int right = first + (down & 1); right <= last; right += 2) visit(down, right);
  });
}

/// Whether it is so of any place within `reach` half pixels.
template <typename IsSo>
bool any_near(int down, int right, int reach, const IsSo& is_so) {
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach + ((reach + y) & 1); x <= reach; x += 2)
      if (is_so(down + y, right + x)) return true;
  return false;
}

}  // namespace

PixelProbes::PixelProbes(const Viewer& viewer, const ProbedPixels& pixels, int reach,
                         const LampParts& lamp_parts)
    : viewer_(viewer),
      pixels_(pixels),
      reach_(reach),
      lamp_parts_(lamp_parts),
      all_{room_for(pixels, reach + kRing, 1), room_for(pixels, reach + kRing, 0)} {
  for (const LightDescription& light : viewer.lights) has_extent_.push_back(has_extent(light));
  everywhere(pixels, reach + kRing,
             [&](int down, int right) { at(down, right) = trace(down, right, kFewShadowRays); });
  if (std::find(has_extent_.begin(), has_extent_.end(), true) == has_extent_.end()) return;
  const Quincunx few = all_;
  everywhere(pixels, reach, [&](int down, int right) {
    if (is_in_penumbra(few, down, right)) at(down, right) = trace(down, right, kManyShadowRays);
  });
}

Probe PixelProbes::trace(int down, int right, int shadow_rays_side) const {
  const std::uint64_t key =
      place_key(pixels_.origin_row + (down >> 1), pixels_.origin_column + (right >> 1), pixels_.image_width);
  const auto random = [&](std::uint64_t n) {
    return random_unit(key, kProbes, 2 * n + static_cast<std::uint64_t>(down & 1));
  };
  return probe_of(viewer_.look(pixels_.origin_column + 0.5 * right, pixels_.origin_row + 0.5 * down,
                               {light_samples({random(0), random(1)}, shadow_rays_side), lamp_parts_}));
}

bool PixelProbes::is_in_penumbra(const Quincunx& probes, int down, int right) const {
  const Probe& middle = at(probes, down, right);
  return any_near(down, right, 2 * kRing, [&](int y, int x) {
    const Probe& near = at(probes, y, x);
    if (near.surface != middle.surface || near.faces_eye != middle.faces_eye) return false;
    if (!alike(near.lamps, middle.lamps)) return true;
    for (std::size_t lamp = 0; lamp < near.lamps.size(); ++lamp) {
      if (!has_extent_[near.lamps[lamp].light] || !near.lamps[lamp].is_above || !middle.lamps[lamp].is_above)
        continue;
      const double visible = near.lamps[lamp].visible;
      if (visible != middle.lamps[lamp].visible || (visible > 0 && visible < 1)) return true;
    }
    return false;
  });
}

bool PixelProbes::agree(int row, int column) const {
  const Probe& middle = center(row, column);
  return !any_near(2 * row + 1, 2 * column + 1, 2 * reach_ + 1, [&](int down, int right) {
    const Probe& probe = at(down, right);
    return probe.surface != middle.surface || probe.faces_eye != middle.faces_eye ||
           !alike(probe.lamps, middle.lamps);
  });
}

std::vector<bool> PixelProbes::edges(int row, int column) const {
  const Probe& middle = center(row, column);
  std::vector<bool> edges(middle.lamps.size(), false);
  any_near(2 * row + 1, 2 * column + 1, 2 * reach_ + 1, [&](int down, int right) {
    const Probe& probe = at(down, right);
    for (std::size_t n = 0; n < edges.size(); ++n) {
      const Probe::Lamp &lamp = probe.lamps[n], &of_middle = middle.lamps[n];
      if (lamp.is_above != of_middle.is_above ||
          (!has_extent_[lamp.light] && lamp.visible != of_middle.visible))
        edges[n] = true;
    }
    return false;
  });
  return edges;
}

ProbesOfFit PixelProbes::of_fit(int row, int column) const {
  ProbesOfFit probes;
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const Eigen::Vector2d& offset = FitStencil::centers_and_corners().offsets()[n];
    probes[n] = &at(2 * row + 1 + static_cast<int>(2 * offset.y()),
                    2 * column + 1 + static_cast<int>(2 * offset.x()));
  }
  return probes;
}

}  // namespace mica::host
