#include "host/app/picture_names.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

#include "host/app/frame_choice.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

namespace fs = std::filesystem;

/// "A-B", or "A".
RowRange parse_rows(const std::string& text, int height) {
  RowRange rows;
  int last = 0;
  const char* const end = text.data() + text.size();
  auto read = std::from_chars(text.data(), end, rows.first);
  last = rows.first;
  if (read.ec == std::errc() && read.ptr != end && *read.ptr == '-')
    read = std::from_chars(read.ptr + 1, end, last);
  if (read.ec != std::errc() || read.ptr != end || rows.first < 0 || last < rows.first || last >= height)
    throw UsageError(
        fmt::format("--rows {}: expected A-B or A, A not above B, of rows 0 to {}", text, height - 1));
  rows.count = last - rows.first + 1;
  return rows;
}

}  // namespace

PictureNames picture_names(const std::string& job, const std::string& output) {
  const fs::path wanted =
      output.empty() ? fs::path("out") / fs::path(job).stem().concat(".exr") : fs::path(output);
  if (wanted.extension() == ".png") return {"", wanted.string()};
  if (wanted.extension() == ".exr")
    return {wanted.string(), fs::path(wanted).replace_extension(".png").string()};
  throw UsageError(fmt::format("-o {}: expected a file name that ends in .exr or .png", wanted.string()));
}

PictureShare picture_share(const std::string& shard, const std::string& rows, int height) {
  if (!shard.empty() && !rows.empty())
    throw UsageError("found both --shard and --rows; either says which part of the picture is rendered");
  PictureShare share;
  if (!rows.empty()) share.rows = parse_rows(rows, height);
  if (shard.empty()) return share;
  share.shard = parse_shard(shard);
  const auto all = static_cast<std::uint64_t>(height);
  const int first = static_cast<int>(share.shard->first(all)), end = static_cast<int>(share.shard->end(all));
  if (first == end) throw UsageError(fmt::format("--shard {}: the picture has only {} rows", shard, height));
  share.rows = RowRange{first, end - first};
  return share;
}

PictureNames names_of_frame(const PictureNames& names, const Job& job, int frame, const PictureShare& share) {
  PictureNames result = names;
  if (job.frames.given) result = {numbered(names.exr, frame), numbered(names.png, frame)};
  if (share.is_all()) return result;
  result.png.clear();  // which `mica join` writes
  if (share.shard) {
    result.exr = shard_name(result.exr, *share.shard);
  } else {
    const std::string marked =
        fmt::format(".rows-{:05}-{:05}.exr", share.rows->first, share.rows->first + share.rows->count - 1);
    result.exr = fs::path(result.exr).replace_extension(marked).string();
  }
  return result;
}

}  // namespace mica::host::app
