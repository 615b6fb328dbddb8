#include "host/image/picture.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <initializer_list>
#include <memory>
#include <new>
#include <utility>

#include "host/image/channel_choice.h"
#include "host/image/file_errors.h"
#include "host/image/image_header.h"
#include "mica/error.h"

namespace mica::host {
namespace {

std::vector<std::string> names_of(const OIIO::ImageSpec& spec, const std::vector<int>& indices) {
  std::vector<std::string> names;
  for (const int n : indices) names.push_back(spec.channelnames[static_cast<std::size_t>(n)]);
  return names;
}

/// One part of a file, and the channels of it that are wanted.
struct Chosen {
  int part = 0;
  ChannelSet channels;
};

/// An open file of which one picture is read.
class PictureReader {
 public:
  PictureReader(const std::string& path, const PictureChoice& choice, PictureUse use, Findings& findings)
      : path_(path), choice_(choice), use_(use), findings_(findings), format_(identify_image(path)) {
    if (format_.reader == "openexr") check_exr_headers(path, format_, use, choice.max_bytes);
    if (format_.reader == "hdr") exposure_ = radiance_exposure(path);
    input_ = OIIO::ImageInput::create(format_.reader);
    if (!input_) fail("this build of OpenImageIO cannot read " + format_.reader + " files");
    OIIO::ImageSpec as_stored, spec;
    as_stored.attribute("oiio:UnassociatedAlpha", 1);
    if (!input_->open(path, spec, as_stored)) fail(reason(input_->geterror()));
    choose();
    check();
  }

  PictureSize size() const {
    const bool turned = spec_.get_int_attribute("Orientation", 1) > 4;
    const bool is_cut = spec_.full_width != spec_.width || spec_.full_height != spec_.height;
    const int width = is_cut ? spec_.full_width : spec_.width,
              height = is_cut ? spec_.full_height : spec_.height;
    return turned ? PictureSize{height, width} : PictureSize{width, height};
  }

  Picture read() {
    Picture picture;
    picture.channels = names_of(spec_, chosen_.channels.indices);
    picture.format = format_.reader;
    picture.type = spec_.format.is_floating_point() ? Picture::Type::floating
                   : spec_.format.is_signed()       ? Picture::Type::signed_integer
                                                    : Picture::Type::unsigned_integer;
    picture.bits = spec_.get_int_attribute("oiio:BitsPerSample", static_cast<int>(8 * spec_.format.size()));
    picture.is_lossy = is_lossy();
    picture.gamma = spec_.get_float_attribute("oiio:Gamma", 0);
    picture.pixels = read_pixels(chosen_.channels.indices);
    if (picture.type != Picture::Type::floating) divide_by_alpha(&picture);
    if (format_.reader == "hdr") divide_by_exposure(&picture);
    arrange(&picture);
    return picture;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw FileError(path_ + ": cannot read: " + message);
  }

  std::string part_name(int part) const {
    const std::string name = specs_[static_cast<std::size_t>(part)].get_string_attribute("oiio:subimagename");
    return name.empty() ? std::to_string(part) : name;
  }

  bool is_wanted(int part) const {
    return choice_.part.empty() || choice_.part == part_name(part) || choice_.part == std::to_string(part);
  }

  /// "part albedo: R, G, B; part normal: X, Y, Z"
  std::string list(const std::vector<Chosen>& sets) const {
    std::vector<std::string> texts;
    for (const Chosen& set : sets) {
      const std::vector<std::string> names =
          names_of(specs_[static_cast<std::size_t>(set.part)], set.channels.indices);
      texts.push_back((specs_.size() > 1 ? "part " + part_name(set.part) + ": " : "") +
                      fmt::format("{}", fmt::join(names, ", ")));
    }
    return fmt::format("{}", fmt::join(texts, "; "));
  }

  void choose() {
    constexpr int most_parts = 1000;
    specs_.push_back(input_->spec());
    // Mip levels of a texture are no pictures of their own.
    const bool has_parts =
        format_.reader == "openexr" ||
        (format_.reader == "tiff" && input_->spec().get_string_attribute("textureformat").empty());
    for (int part = 1; has_parts && part < most_parts && input_->seek_subimage(part, 0); ++part)
      specs_.push_back(input_->spec());
    input_->geterror();  // that there are no more
    const bool is_sequence =
        format_.reader != "tiff" && !has_parts && input_->spec().get_int_attribute("oiio:subimages", 1) > 1;
    if (is_sequence || is_animated_webp()) fail("holds several pictures, as an animation does; expected one");
    std::vector<Chosen> fitting, all;
    for (int part = 0; part < static_cast<int>(specs_.size()); ++part) {
      const OIIO::ImageSpec& spec = specs_[static_cast<std::size_t>(part)];
      all.push_back({part, {}});
      for (int n = 0; n < spec.nchannels; ++n) all.back().channels.indices.push_back(n);
      if (!is_wanted(part)) continue;
      for (ChannelSet& set :
           fitting_channels(spec.channelnames, spec.alpha_channel, use_, choice_.channels)) {
        if (use_ == PictureUse::map && says_normal(part_name(part))) set.rank = 0;
        fitting.push_back({part, std::move(set)});
      }
    }
    keep_best(&fitting);
    const char* what = use_ == PictureUse::map ? "a map's X, Y, Z or R, G, B, two of them, or a single height"
                                               : "a colour's R, G, B, or a single grey";
    if (fitting.empty()) fail(fmt::format("found the channels {}; expected {}{}", list(all), what, asked()));
    if (fitting.size() > 1)
      fail(fmt::format("found more than one that fits ({}); say which by `part` or `channels`",
                       list(fitting)));
    chosen_ = fitting.front();
    spec_ = specs_[static_cast<std::size_t>(chosen_.part)];
    note_choice();
  }

  /// OpenImageIO reads the first frame and says nothing of the others.
  bool is_animated_webp() const {
    constexpr std::size_t flags = 20;  // of the extended header
    constexpr char animation = 2;
    return format_.reader == "webp" && format_.first_bytes.compare(12, 4, "VP8X") == 0 &&
           format_.first_bytes.size() > flags && (format_.first_bytes[flags] & animation) != 0;
  }

  static void keep_best(std::vector<Chosen>* sets) {
    int best = 99;
    for (const Chosen& set : *sets) best = std::min(best, set.channels.rank);
    sets->erase(std::remove_if(sets->begin(), sets->end(),
                               [&](const Chosen& set) { return set.channels.rank > best; }),
                sets->end());
  }

  std::string asked() const {
    std::string text;
    if (!choice_.part.empty()) text += ", in the part " + choice_.part;
    if (!choice_.channels.empty()) text += ", of the channels " + choice_.channels;
    return text;
  }

  void note_choice() {
    std::vector<int> ignored;
    for (int n = 0; n < spec_.nchannels; ++n)
      if (std::find(chosen_.channels.indices.begin(), chosen_.channels.indices.end(), n) ==
          chosen_.channels.indices.end())
        ignored.push_back(n);
    const std::string of_part =
        specs_.size() > 1 ? fmt::format("part {} of {}; ", part_name(chosen_.part), specs_.size()) : "";
    if (!ignored.empty() || !of_part.empty())
      findings_.notes.push_back(fmt::format(
          "{}channels used: {}; ignored: {}", of_part,
          fmt::join(names_of(spec_, chosen_.channels.indices), ", "),
          ignored.empty() ? "none" : fmt::format("{}", fmt::join(names_of(spec_, ignored), ", "))));
  }

  void check() const {
    DeclaredPixels declared{spec_.width,
                            spec_.height,
                            spec_.nchannels,
                            static_cast<std::int64_t>(spec_.format.size()),
                            spec_.tile_width,
                            spec_.tile_height,
                            spec_.get_string_attribute("compression")};
    check_declared(path_, format_, declared, use_, choice_.max_bytes);
    if (spec_.depth > 1 || spec_.deep) fail("holds volume or deep pixels, expected a flat image");
    check_windows(declared);
    check_colors();
  }

  bool is_whole() const {
    return spec_.x == spec_.full_x && spec_.y == spec_.full_y && spec_.width == spec_.full_width &&
           spec_.height == spec_.full_height;
  }

  void check_windows(DeclaredPixels declared) const {
    if (is_whole()) return;
    declared.width = spec_.full_width, declared.height = spec_.full_height;
    declared.tile_width = declared.tile_height = 0;
    check_declared(path_, format_, declared, use_, choice_.max_bytes);
    const bool covers = spec_.x <= spec_.full_x && spec_.y <= spec_.full_y &&
                        spec_.x + spec_.width >= spec_.full_x + spec_.full_width &&
                        spec_.y + spec_.height >= spec_.full_y + spec_.full_height;
    if (use_ == PictureUse::map && !covers)
      fail(fmt::format(
          "the data window of {} x {} pixels at ({}, {}) is a part of the display window of {} x {} "
          "pixels; expected a whole map: cut it out with oiiotool --trim, or fill the rest",
          spec_.width, spec_.height, spec_.x - spec_.full_x, spec_.y - spec_.full_y, spec_.full_width,
          spec_.full_height));
  }

  /// What is not RGB of Rec. 709 primaries; numbers of a map have no colour.
  void check_colors() const {
    for (const char* name : {"tiff:ColorSpace", "jpeg:ColorSpace", "psd:ColorSpace"}) {
      const std::string space = spec_.get_string_attribute(name);
      if (space == "CMYK" || space == "YCCK" || space == "CIELAB" || space == "ICCLAB" || space == "ITULAB")
        fail(fmt::format("holds {} pixels; expected RGB or grey: convert it to sRGB", space));
    }
    const std::string format = spec_.get_string_attribute("textureformat");
    if (format.find("Cube") != format.npos) fail("is a cube map; expected a flat image");
    if (use_ == PictureUse::map) return;
    if (const OIIO::ParamValue* found = spec_.find_attribute("chromaticities");
        found && found->datasize() == 32)
      check_primaries(static_cast<const float*>(found->data()));
    if (const OIIO::ParamValue* found = spec_.find_attribute("ICCProfile"))
      check_profile(
          std::string(static_cast<const char*>(found->data()), static_cast<std::size_t>(found->datasize())));
  }

  void check_primaries(const float* found) const {
    constexpr float rec_709[] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
    for (int n = 0; n < 8; ++n)
      if (!(std::abs(found[n] - rec_709[n]) < 5e-3f))
        fail(fmt::format("has the chromaticities ({:.4g}), expected those of sRGB (Rec. 709): convert it",
                         fmt::join(found, found + 8, ", ")));
  }

  /// A profile's name is in ASCII or in UTF-16; "c2" is the name of a short form of sRGB.
  void check_profile(std::string profile) const {
    profile.erase(std::remove(profile.begin(), profile.end(), '\0'), profile.end());
    for (const char* name : {"sRGB", "Rec.709", "Rec709", "Rec. 709", "BT.709", "c2"})
      if (profile.find(name) != profile.npos) return;
    fail("carries an ICC profile that does not say sRGB, which Mica cannot apply: convert it to sRGB");
  }

  bool is_lossy() const {
    if (format_.reader == "webp") return format_.first_bytes.compare(12, 4, "VP8L") != 0;
    const std::string compression = spec_.get_string_attribute("compression");
    for (const char* name : {"b44", "b44a", "dwaa", "dwab", "jpeg", "pxr24"})
      if (compression.compare(0, std::string(name).size(), name) == 0) return true;
    return format_.reader == "jpeg" || format_.reader == "jpeg2000" ||
           (format_.reader == "dds" && !compression.empty());
  }

  std::vector<float> read_pixels(const std::vector<int>& indices) {
    const std::size_t count = indices.size();
    std::vector<float> pixels(static_cast<std::size_t>(spec_.width) * static_cast<std::size_t>(spec_.height) *
                              count);
    // The TIFF reader returns true for strips it could not read and leaves only the message, with the thread
    // it ran on.
    input_->threads(1);
    for (std::size_t n = 0, run; n < count; n += run) {
      for (run = 1; n + run < count && indices[n + run] == indices[n] + static_cast<int>(run);) ++run;
      const bool is_read =
          input_->read_image(chosen_.part, 0, indices[n], indices[n] + static_cast<int>(run), OIIO::TypeFloat,
                             pixels.data() + n, static_cast<OIIO::stride_t>(count * sizeof(float)));
      if (!is_read || input_->has_error()) fail("the pixels: " + reason(input_->geterror()));
    }
    return pixels;
  }

  /// TIFF can hold colours that alpha has been multiplied into, before their curve, and OpenImageIO 2.4
  /// always multiplies those of WebP.
  void divide_by_alpha(Picture* picture) {
    const bool can_be = format_.reader == "tiff" || format_.reader == "webp";
    const bool is_associated =
        can_be && spec_.alpha_channel >= 0 && spec_.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0;
    if (!is_associated) return;
    const std::vector<float> alpha = read_pixels({spec_.alpha_channel});
    const std::size_t count = picture->channels.size();
    for (std::size_t n = 0; n < picture->pixels.size(); ++n)
      if (const float a = alpha[n / count]; a > 0)
        picture->pixels[n] = std::min(picture->pixels[n] / a, 1.0f);
    findings_.notes.push_back("associated alpha divided out");
  }

  void divide_by_exposure(Picture* picture) {
    if (exposure_ == std::array<double, 3>{1, 1, 1}) return;
    for (std::size_t n = 0; n < picture->pixels.size(); ++n)
      picture->pixels[n] = static_cast<float>(picture->pixels[n] / exposure_[n % 3]);
    findings_.notes.push_back(fmt::format("exposure of {:g} divided out", fmt::join(exposure_, ", ")));
  }

  /// The display window, as a viewer shows it.
  void arrange(Picture* picture) {
    const int orientation = spec_.get_int_attribute("Orientation", 1);
    picture->width = spec_.full_width, picture->height = spec_.full_height;
    if (!is_whole()) place_in_display_window(picture);
    if (orientation != 1) turn(picture, orientation);
  }

  void place_in_display_window(Picture* picture) {
    const int channels = static_cast<int>(picture->channels.size());
    OIIO::ImageSpec spec(spec_.width, spec_.height, channels, OIIO::TypeFloat);
    spec.x = spec_.x, spec.y = spec_.y;
    OIIO::ImageBuf stored(spec, picture->pixels.data());
    const OIIO::ROI window(spec_.full_x, spec_.full_x + spec_.full_width, spec_.full_y,
                           spec_.full_y + spec_.full_height, 0, 1, 0, channels);
    std::vector<float> pixels(static_cast<std::size_t>(window.npixels()) *
                              static_cast<std::size_t>(channels));
    if (!stored.get_pixels(window, OIIO::TypeFloat, pixels.data())) fail(stored.geterror());
    picture->pixels = std::move(pixels);  // what the data window does not cover is black
    findings_.notes.push_back(
        fmt::format("the data window of {} x {} pixels is placed in the display window of {} x {}",
                    spec_.width, spec_.height, spec_.full_width, spec_.full_height));
  }

  /// Exif's orientations; those of OpenImageIO 2.4 have 5 and 7 the wrong way round.
  void turn(Picture* picture, int orientation) {
    const auto is = [&](std::initializer_list<int> some) {
      return std::find(some.begin(), some.end(), orientation) != some.end();
    };
    const bool transposed = orientation > 4, mirror_x = is({2, 3, 7, 8}), mirror_y = is({3, 4, 6, 7});
    const int width = picture->width, height = picture->height;
    if (transposed) std::swap(picture->width, picture->height);
    const std::size_t channels = picture->channels.size();
    std::vector<float> pixels;
    pixels.reserve(picture->pixels.size());
    for (int y = 0; y < picture->height; ++y)
      for (int x = 0; x < picture->width; ++x) {
        const int i = transposed ? y : x, j = transposed ? x : y;
        const int column = mirror_x ? width - 1 - i : i, row = mirror_y ? height - 1 - j : j;
        const float* pixel =
            &picture->pixels[(static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(column)) *
                             channels];
        pixels.insert(pixels.end(), pixel, pixel + channels);
      }
    picture->pixels = std::move(pixels);
    findings_.notes.push_back(fmt::format("turned as its orientation tag {} says", orientation));
  }

  const std::string& path_;
  const PictureChoice& choice_;
  PictureUse use_;
  Findings& findings_;
  ImageFileFormat format_;
  std::unique_ptr<OIIO::ImageInput> input_;
  std::vector<OIIO::ImageSpec> specs_;  // one a part
  Chosen chosen_;
  OIIO::ImageSpec spec_;  // of the chosen part
  std::array<double, 3> exposure_{1, 1, 1};
};

}  // namespace

Picture read_picture(const std::string& path, const PictureChoice& choice, PictureUse use,
                     Findings* findings) {
  Findings unread;
  return with_file_errors(
      path, [&] { return PictureReader(path, choice, use, findings ? *findings : unread).read(); });
}

PictureSize picture_size(const std::string& path, const PictureChoice& choice, PictureUse use) {
  Findings unread;
  return with_file_errors(path, [&] { return PictureReader(path, choice, use, unread).size(); });
}

}  // namespace mica::host
