#pragma once

#include <string>
#include <vector>

#include "host/render/render.h"

namespace mica::host {

/// Makes the image of some rows, as rendered, one that can be joined: its attributes carry what the whole
/// will need, the audited samples and pixels and how the preview is shown, in place of the audit of these
/// rows alone.
void make_part(const Job& job, RenderResult* result);

/// A part that was read with read_stored_picture.
struct PicturePart {
  std::string path;
  Image image;
};

/// A picture from its parts.
struct JoinedPicture {
  Image image;
  double exposure = 0;
  ToneMap tone_map = ToneMap::shoulder;
};

/// The picture that its parts are rows of, bit for bit as if it had been rendered at once, with one audit
/// over all. Parts by several devices name them all. Throws UsageError that names every part that is no part,
/// is of another picture, or has rows that another one has as well, and the rows that none has.
JoinedPicture join(std::vector<PicturePart> parts);

}  // namespace mica::host
