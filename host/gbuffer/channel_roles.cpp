#include "host/gbuffer/channel_roles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>

#include "host/base/printable.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// Names of layers for a role, by preset; the first that is there counts. Ids of materials before those of
/// objects.
std::vector<std::string> names_of(BufferPreset preset, BufferRole role) {
  using Names = std::map<BufferRole, std::vector<std::string>>;
  static const std::map<BufferPreset, Names> all = {{BufferPreset::blender5,
                                                     {{BufferRole::position, {"Position"}},
                                                      {BufferRole::normal, {"smooth_normal", "Normal"}},
                                                      {BufferRole::true_normal, {"true_normal"}},
                                                      {BufferRole::tangent, {"tangent"}},
                                                      {BufferRole::uv, {"UV"}},
                                                      {BufferRole::id, {"glint_id", "Material Index"}}}},
                                                    {BufferPreset::blender3,
                                                     {{BufferRole::position, {"Position"}},
                                                      {BufferRole::normal, {"smooth_normal", "Normal"}},
                                                      {BufferRole::true_normal, {"true_normal"}},
                                                      {BufferRole::tangent, {"tangent"}},
                                                      {BufferRole::uv, {"UV"}},
                                                      {BufferRole::id, {"glint_id", "IndexMA"}}}},
                                                    {BufferPreset::mitsuba,
                                                     {{BufferRole::position, {"position"}},
                                                      {BufferRole::normal, {"sh_normal"}},
                                                      {BufferRole::true_normal, {"geo_normal"}},
                                                      {BufferRole::dp_du, {"dp_du"}},
                                                      {BufferRole::dp_dv, {"dp_dv"}},
                                                      {BufferRole::uv_dx, {"duv_dx"}},
                                                      {BufferRole::uv_dy, {"duv_dy"}},
                                                      {BufferRole::uv, {"uv"}},
                                                      {BufferRole::id, {"glint_id", "shape_index"}}}},
                                                    {BufferPreset::arnold,
                                                     {{BufferRole::position, {"P"}},
                                                      {BufferRole::normal, {"Nsmooth", "N"}},
                                                      {BufferRole::true_normal, {"Ng"}},
                                                      {BufferRole::dp_du, {"dPdu"}},
                                                      {BufferRole::dp_dv, {"dPdv"}},
                                                      {BufferRole::uv, {"uv", "UV"}},
                                                      {BufferRole::id, {"glint_id", "ID"}}}},
                                                    {BufferPreset::karma,
                                                     {{BufferRole::position, {"P"}},
                                                      {BufferRole::normal, {"N"}},
                                                      {BufferRole::true_normal, {"Ng"}},
                                                      {BufferRole::tangent, {"tangentu"}},
                                                      {BufferRole::dp_du, {"dPdu"}},
                                                      {BufferRole::dp_dv, {"dPdv"}},
                                                      {BufferRole::uv, {"uv"}},
                                                      {BufferRole::id, {"glint_id", "id"}}}}};
  const Names& names = all.at(preset);
  const auto found = names.find(role);
  return found == names.end() ? std::vector<std::string>() : found->second;
}

std::vector<std::vector<std::string>> suffixes(BufferRole role) {
  if (role == BufferRole::id) return {{".X"}, {".V"}, {".I"}, {".Y"}, {".R"}, {".x"}, {""}};
  if (role == BufferRole::uv || role == BufferRole::uv_dx || role == BufferRole::uv_dy)
    return {{".U", ".V"}, {".u", ".v"}, {".X", ".Y"}, {".x", ".y"}, {".R", ".G"}, {".r", ".g"}};
  return {{".X", ".Y", ".Z"}, {".R", ".G", ".B"}, {".x", ".y", ".z"}, {".r", ".g", ".b"}};
}

bool may_be_absent(BufferRole role) {
  return role != BufferRole::position && role != BufferRole::normal && role != BufferRole::uv &&
         role != BufferRole::id;
}

class Finder {
 public:
  explicit Finder(const ChannelFile& file) : file_(file) {}

  /// A channel of this name, or of a layer's layer that has it: "ViewLayer.UV.U" for "UV.U".
  std::optional<int> channel(const std::string& name) const {
    std::optional<int> found;
    for (int n = 0; n < static_cast<int>(file_.channels().size()); ++n) {
      const std::string& other = file_.channels()[static_cast<std::size_t>(n)].name;
      const bool same = other == name, ends = has_end(other, "." + name);
      if (!same && !ends) continue;
      if (found && !same)
        throw FileError(fmt::format("{}: found {} and {}; say which by --channel ROLE=NAME", file_.path(),
                                    printable(file_.channels()[static_cast<std::size_t>(*found)].name),
                                    printable(other)));
      found = n;
      if (same) break;
    }
    return found;
  }

  std::vector<int> layer(BufferRole role, const std::string& name) const {
    for (const std::vector<std::string>& ends : suffixes(role)) {
      std::vector<int> places;
      for (const std::string& end : ends)
        if (const std::optional<int> found = channel(name + end)) places.push_back(*found);
      if (places.size() == ends.size()) return places;
    }
    return {};
  }

  /// Names with commas between them.
  std::vector<int> listed(BufferRole role, const std::string& names) const {
    std::vector<int> places;
    for (std::size_t begin = 0; begin <= names.size();) {
      const std::size_t end = std::min(names.find(',', begin), names.size());
      if (const std::optional<int> found = channel(names.substr(begin, end - begin)))
        places.push_back(*found);
      begin = end + 1;
    }
    return places.size() == suffixes(role).front().size() ? places : std::vector<int>();
  }

  [[noreturn]] void fail(BufferRole role, const std::vector<std::string>& names) const {
    std::vector<std::string> ends, all;
    for (const std::vector<std::string>& some : suffixes(role))
      ends.push_back(fmt::format("{}", fmt::join(some, " ")));
    for (const FileChannel& channel : file_.channels()) all.push_back(printable(channel.name));
    throw FileError(
        fmt::format("{}: found no channels for {}; looked for {} with {} (whatever layer they are in; others "
                    "by --channel "
                    "{}=NAME); the file has {}",
                    file_.path(), word_of(role), fmt::join(names, ", "), fmt::join(ends, " or "),
                    word_of(role), fmt::join(all, ", ")));
  }

 private:
  static bool has_end(const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
  }
  const ChannelFile& file_;
};

using ByHand = std::map<BufferRole, std::string>;

ByHand parse(const std::vector<std::string>& texts) {
  ByHand names;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::optional<BufferRole> role = parse_word<BufferRole>(text.substr(0, equals));
    if (!role || equals == std::string::npos || equals + 1 == text.size())
      throw UsageError(fmt::format("--channel {}: expected ROLE=NAME, ROLE one of: {}", printable(text),
                                   fmt::join(list_words<BufferRole>(), ", ")));
    names[*role] = text.substr(equals + 1);
  }
  return names;
}

void refuse_half(const ChannelFile& file, const std::vector<int>& places) {
  for (const int place : places) {
    const FileChannel& channel = file.channels()[static_cast<std::size_t>(place)];
    if (channel.is_float) continue;
    throw FileError(fmt::format(
        "{}: the channel {} has 16 bits, too few to tell footprints (they would be off by several percent); "
        "write the G-buffer as 32-bit floats",
        file.path(), printable(channel.name)));
  }
}

}  // namespace

BufferChannels find_buffer_channels(const ChannelFile& file, const std::vector<BufferPreset>& presets,
                                    const std::vector<std::string>& by_hand) {
  const ByHand given = parse(by_hand);
  std::vector<BufferPreset> chosen = presets;
  if (chosen.empty())
    for (const Word<BufferPreset>& entry : Words<BufferPreset>::all) chosen.push_back(entry.value);
  const Finder finder(file);
  BufferChannels channels;
  for (const Word<BufferRole>& entry : Words<BufferRole>::all) {
    const BufferRole role = entry.value;
    std::vector<int>& places = channels[static_cast<std::size_t>(role)];
    std::vector<std::string> names;
    if (const auto named = given.find(role); named != given.end()) {
      names = {printable(named->second)};
      places = finder.layer(role, named->second);
      if (places.empty()) places = finder.listed(role, named->second);
      if (places.empty()) finder.fail(role, names);
    }
    for (const BufferPreset preset : chosen)
      for (const std::string& name : names_of(preset, role)) {
        if (!places.empty()) break;
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
        places = finder.layer(role, name);
      }
    if (places.empty() && !may_be_absent(role)) finder.fail(role, names);
    if (role == BufferRole::uv || role == BufferRole::position) refuse_half(file, places);
  }
  return channels;
}

std::vector<int> find_lamp_channels(const ChannelFile& file, const std::string& lamp) {
  const Finder finder(file);
  std::vector<int> places;
  for (const char* end : {".R", ".G", ".B"})
    if (const std::optional<int> found = finder.channel("Lamps.Combined_" + lamp + end))
      places.push_back(*found);
  return places.size() == 3 ? places : std::vector<int>();
}

}  // namespace mica::host
