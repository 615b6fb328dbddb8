#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/base/words.h"
#include "host/image/channel_file.h"

namespace mica::host {

/// What a channel of a G-buffer is for.
enum class BufferRole { position, normal, true_normal, tangent, uv, uv_dx, uv_dy, dp_du, dp_dv, id };

template <>
struct Words<BufferRole> {
  static constexpr Word<BufferRole> all[] = {{"position", BufferRole::position},
                                             {"normal", BufferRole::normal},
                                             {"true_normal", BufferRole::true_normal},
                                             {"tangent", BufferRole::tangent},
                                             {"uv", BufferRole::uv},
                                             {"uv_dx", BufferRole::uv_dx},
                                             {"uv_dy", BufferRole::uv_dy},
                                             {"dp_du", BufferRole::dp_du},
                                             {"dp_dv", BufferRole::dp_dv},
                                             {"id", BufferRole::id}};
};
constexpr std::size_t kBufferRoles = 10;

/// Whose names of channels are looked for.
enum class BufferPreset { blender5, blender3, mitsuba, arnold, karma };

template <>
struct Words<BufferPreset> {
  static constexpr Word<BufferPreset> all[] = {{"blender5", BufferPreset::blender5},
                                               {"blender3", BufferPreset::blender3},
                                               {"mitsuba", BufferPreset::mitsuba},
                                               {"arnold", BufferPreset::arnold},
                                               {"karma", BufferPreset::karma}};
};

/// Places in ChannelFile::channels() by role; empty for one that is not there and need not be: the true
/// normal, for which the smooth one stands, the tangent, which follows from uv and position, and derivatives,
/// for which differences between neighbours stand.
using BufferChannels = std::array<std::vector<int>, kBufferRoles>;

/// @param presets empty: all. @param by_hand "ROLE=NAME" each; NAME is a layer, "ViewLayer.Position", or
/// names of channels with commas between them. Throws UsageError for words that are none; FileError for
/// channels that are missing, with the names under which they were looked for, and for uv and positions of 16
/// bits.
BufferChannels find_buffer_channels(const ChannelFile& file, const std::vector<BufferPreset>& presets,
                                    const std::vector<std::string>& by_hand);

/// The light of a lamp alone on white diffuse surfaces, `Lamps.Combined_LAMP.R`, G and B; empty: not there.
std::vector<int> find_lamp_channels(const ChannelFile& file, const std::string& lamp);

}  // namespace mica::host
