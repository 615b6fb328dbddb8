#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/app/shard.h"
#include "host/job/job.h"
#include "host/render/render.h"

namespace mica::host::app {

/// FILE.exr and its preview FILE.png; empty where it is not written.
struct PictureNames {
  std::string exr, png;
};

/// What `-o` asks for: FILE.exr, with its preview beside it, or FILE.png, the preview alone; by default
/// out/<name of the job>.exr. Throws UsageError for another ending.
PictureNames picture_names(const std::string& job, const std::string& output);

/// What is rendered of a picture: `--shard` or `--rows`.
struct PictureShare {
  std::optional<Shard> shard;
  std::optional<RowRange> rows;  ///< none: all

  bool is_all() const { return !rows; }
};
/// @param rows "A-B" or "A", from 0 at the top. Throws UsageError for both, and for what the picture has not.
PictureShare picture_share(const std::string& shard, const std::string& rows, int height);

/// Names of one frame's files: numbered when the job has frames, and told from others when they are a part.
PictureNames names_of_frame(const PictureNames& names, const Job& job, int frame, const PictureShare& share);

}  // namespace mica::host::app
