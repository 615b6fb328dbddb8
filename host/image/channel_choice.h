#pragma once

#include <string>
#include <vector>

#include "host/image/picture.h"

namespace mica::host {

/// Channels of one part that make a picture.
struct ChannelSet {
  std::vector<int> indices;
  int rank = 0;  ///< the least fits best
};

/// Whether a layer or part of this name holds normals.
bool says_normal(const std::string& name);

/// The sets among `names` that can be a map or a colour; those that fit best, of one rank.
/// @param alpha index of the alpha channel, or -1. @param wanted as PictureChoice::channels.
std::vector<ChannelSet> fitting_channels(const std::vector<std::string>& names, int alpha, PictureUse use,
                                         const std::string& wanted);

}  // namespace mica::host
