#pragma once

#include <fmt/format.h>

#include "host/job/toml_reader.h"
#include "host/scene/description.h"

namespace mica::host {

/// The array `keys` of a camera or a light: each key has a `frame`, and says what is different there from the
/// table itself.
/// @param read reads such values into a description.
template <class Described, class Read>
Keyframes<Described> read_keyframes(TableReader& table, const Described& still, const Read& read) {
  Keyframes<Described> keys;
  if (!table.has("keys")) return keys;
  table.read_table_array("keys", [&](TableReader& key) {
    double frame = 0;
    if (key.require("frame", "the number of a frame")) key.read("frame", frame, closed(-1e6, 1e6));
    if (!keys.empty() && frame <= keys.back().frame)
      key.report("frame",
                 fmt::format("found {} after {}; expected frames that increase", frame, keys.back().frame));
    keys.push_back({frame, still});
    read(key, keys.back().value);
  });
  return keys;
}

}  // namespace mica::host
