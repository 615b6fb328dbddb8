#pragma once

#include <string>

#include "host/image/image.h"

namespace mica::host {

/// What the name of each of Mica's own attributes in a file begins with.
constexpr char kOwnAttribute[] = "mica:";

/// Reads a picture that write_exr or write_png wrote: its pixels (of a PNG as displayed, 0 to 1), where they
/// are in the whole, and Mica's own attributes. It is read through to its end, and its pixels must be those
/// that were written. Throws FileError for what is missing, no such picture, cut short or changed.
Image read_stored_picture(const std::string& path);

}  // namespace mica::host
