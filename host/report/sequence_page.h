// A sequence's state as a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/image/image.h"

namespace mica::host {

/// What is known of one frame.
enum class FrameState { done, running, failed, missing };

template <>
struct Words<FrameState> {
  static constexpr Word<FrameState> all[] = {{"done", FrameState::done},
                                             {"running", FrameState::running},
                                             {"failed", FrameState::failed},
                                             {"missing", FrameState::missing}};
};

struct FrameStatus {
  int frame = 0;
  FrameState state = FrameState::missing;
  std::string note;                ///< where it runs, why it failed
  std::optional<double> seconds;   ///< that it took
  std::optional<Image> thumbnail;  ///< small; channels R, G, B or one
};

/// The frames of one output, in their order.
struct SequenceStatus {
  std::string output;  ///< "ocean.exr"
  std::string job;     ///< as it was named; empty: no log tells
  std::vector<FrameStatus> frames;

  int count(FrameState state) const;
  /// Those that are neither done nor running.
  std::vector<int> remaining() const;
};

/// At most `side` pixels high and wide: means of the pixels that fall together.
Image thumbnail_of(const Image& image, int side);

/// HTML that needs no network. @param title e.g. the folder.
std::string sequence_page(const std::string& title, const std::vector<SequenceStatus>& sequences);

}  // namespace mica::host
