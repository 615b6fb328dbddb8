#pragma once

#include "host/scene/pixel_fit.h"
#include "host/scene/rectangle.h"

namespace mica::host {

/// Pixels of a block. Rows and columns count from the block's first pixel, that at `origin_row` and
/// `origin_column` of an image `image_width` pixels wide.
struct ProbedPixels {
  int first_row, end_row, first_column, end_column;
  int origin_row, origin_column, image_width;
};

/// The rays that pixels are fitted to: one through each centre and one through each corner, which four pixels
/// share. Four shadow rays say how much of a lamp with extent is seen; where they or those of the rays around
/// do not agree thirty-six do. What a ray finds does not depend on which pixels are asked for.
class PixelProbes {
 public:
  /// @param viewer must outlive it. @param reach how many pixels around those asked for are looked at.
  PixelProbes(const Viewer& viewer, const ProbedPixels& pixels, int reach, const LampParts& lamp_parts);

  const Probe& center(int row, int column) const { return at(2 * row + 1, 2 * column + 1); }

  /// Whether all rays within reach of a pixel meet one surface.
  bool agree(int row, int column) const;

  /// By lamp, of a pixel whose rays agree: whether it has an edge within reach. It has none where it is above
  /// the horizon for all rays or none, and shadows have no edge: a lamp without extent is seen by all or
  /// none.
  std::vector<bool> edges(int row, int column) const;

  /// By place of FitStencil::centers_and_corners().
  ProbesOfFit of_fit(int row, int column) const;

 private:
  // Places are in half pixels: those of centres are odd, those of corners even.
  using Quincunx = std::array<Rectangle<Probe>, 2>;  // corners, each the upper left one of its pixel; centres
  static const Probe& at(const Quincunx& probes, int down, int right) {
    return probes[static_cast<std::size_t>(down & 1)].at(down >> 1, right >> 1);
  }
  Probe& at(int down, int right) {
    return all_[static_cast<std::size_t>(down & 1)].at(down >> 1, right >> 1);
  }
  const Probe& at(int down, int right) const { return at(all_, down, right); }
  Probe trace(int down, int right, int shadow_rays_side) const;
  bool is_in_penumbra(const Quincunx& probes, int down, int right) const;

  const Viewer& viewer_;
  const ProbedPixels pixels_;
  const int reach_;
  const LampParts lamp_parts_;
  std::vector<bool> has_extent_;  // by lamp
  Quincunx all_;
};

}  // namespace mica::host
