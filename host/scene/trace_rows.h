#pragma once

#include "host/scene/viewer.h"

namespace mica::host {

/// A part of an image. What `TracedRows` tells of it has its width.
struct ImagePart {
  int image_width, image_height;
  int first_row, row_count;
  int first_column, column_count;
};

/// Traces a part of an image; see Scene. Of whole rows, if pixels are to be fitted.
TracedRows trace_rows(const Viewer& viewer, const PixelSettings& pixels, const ImagePart& part);

/// Takes some samples of a part, see Scene::sample.
TracedRows sample_rows(const Viewer& viewer, const PixelSettings& pixels, const ImagePart& part,
                       const Lattice::Choice& chosen);

}  // namespace mica::host
