#pragma once

#include <vector>

#include "host/gbuffer/gbuffer.h"
#include "host/scene/scene.h"

namespace mica::host {

/// Pixels of a G-buffer by what became of them.
struct BufferCounts {
  std::size_t covered = 0;    ///< with a material
  std::size_t one_sided = 0;  ///< of these at a rim or a seam, whose neighbours lie on one side
  std::size_t alone = 0;   ///< of these without neighbours, whose footprint is not known: they show nothing
  std::size_t broken = 0;  ///< with numbers that are none; not covered

  BufferCounts& operator+=(const BufferCounts& other);
};

/// A layer's rows from a G-buffer, in place of those that a camera sees.
///
/// Its pixels stand for rays through their centres. Where a pixel and its eight neighbours lie on one surface
/// they are fitted as a picture's pixels are (see PixelFit). Elsewhere uv and half vectors change along the
/// surface as the neighbours tell that there are, and the camera says how the surface lies in the pixel. With
/// several pixels of the buffer a pixel of the layer, these are the samples of its lattice.
class BufferTracer {
 public:
  /// @param buffer, view have to outlive it. @param scale as GBuffer's.
  BufferTracer(GBuffer* buffer, const BufferView& view, int scale);

  /// Rows of the layer with queries, and their coverage. The light is that of glints alone.
  /// @param scene with the view's lamps as its lights.
  TracedRows trace(const Scene& scene, int first_row, int row_count);

  /// Of all rows that were traced.
  BufferCounts counts() const;

 private:
  GBuffer* buffer_;
  const BufferView& view_;
  int scale_, width_, height_;
  std::vector<BufferCounts> counts_;  // by row
};

}  // namespace mica::host
