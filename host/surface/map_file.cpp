#include "host/surface/map_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/surface/disk.h"
#include "host/surface/fill_holes.h"
#include "host/surface/map_precision.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr double kShortestNormal = 0.01;  // what is shorter has no direction to speak of

std::string describe(const MapPixels& pixels) {
  switch (pixels.type) {
    case MapPixels::Type::unsigned_integer:
      return fmt::format("{}-bit unsigned integer pixels", pixels.bits);
    case MapPixels::Type::signed_integer:
      return fmt::format("{}-bit signed integer pixels", pixels.bits);
    case MapPixels::Type::floating:
      break;
  }
  return fmt::format("{}-bit float pixels", pixels.bits);
}

/// How far normals are from length 1 in the mean, read as they are or as 2c - 1.
double mean_length_error(const MapPixels& pixels, bool as_unorm) {
  double sum = 0;
  for (std::size_t n = 0; n + 2 < pixels.pixels.size(); n += 3) {
    Eigen::Vector3d normal(pixels.pixels[n], pixels.pixels[n + 1], pixels.pixels[n + 2]);
    if (as_unorm) normal = 2 * normal - Eigen::Vector3d::Ones();
    if (normal.allFinite()) sum += std::abs(normal.norm() - 1);
  }
  return sum;
}

/// Normals are offered as 0..1 in float pixels, too: no bump leans one way alone, so that some must be
/// negative.
Encoding encoding_of_floats(const MapFile& file, const MapPixels& pixels) {
  const auto is_negative = [](float value) { return value < 0; };
  const auto& values = pixels.pixels;
  if (std::any_of(values.begin(), values.end(), is_negative)) return Encoding::signed_float;
  if (pixels.channels.size() == 3)
    return mean_length_error(pixels, true) < mean_length_error(pixels, false) ? Encoding::unorm
                                                                              : Encoding::signed_float;
  if (std::all_of(values.begin(), values.end(), [](float value) { return value == 0; }))
    return Encoding::signed_float;
  throw UsageError(fmt::format(
      "{}: found {} without a negative one in two channels; say encoding = \"unorm\" (0..1) or \"signed\"",
      file.path, describe(pixels)));
}

/// Whether the third channel holds nothing, so that the first two are a map of two channels (BC5) saved as
/// RGB.
bool third_says_nothing(const MapPixels& pixels, Encoding encoding) {
  if (pixels.channels.size() != 3 || encoding == Encoding::slope || encoding == Encoding::height)
    return false;
  const float first = pixels.pixels[2];
  for (std::size_t n = 2; n < pixels.pixels.size(); n += 3)
    if (pixels.pixels[n] != first) return false;
  const bool is_middle = encoding == Encoding::unorm && std::abs(2 * first - 1) <= 1.0f / 127;
  return first == 0 || is_middle;
}

Encoding choose_encoding(const MapFile& file, const MapPixels& pixels, SurfaceReport& report) {
  const bool is_unsigned = pixels.type == MapPixels::Type::unsigned_integer;
  if (!file.encoding_given) {
    if (pixels.channels.size() == 1) {
      throw UsageError(file.path + ": has one channel; say encoding = \"height\" and its height_scale");
    }
    const bool is_float = pixels.type == MapPixels::Type::floating;
    const Encoding assumed = is_unsigned ? Encoding::unorm
                             : is_float  ? encoding_of_floats(file, pixels)
                                         : Encoding::signed_float;
    report.notes.push_back(
        fmt::format("encoding {} assumed from {}{}", word_of(assumed), describe(pixels),
                    is_float && assumed == Encoding::unorm ? ", none of them negative" : ""));
    return assumed;
  }
  if (pixels.channels.size() == 1 && file.encoding != Encoding::height) {
    throw UsageError(fmt::format("{}: has one channel; encoding {} needs two or three", file.path,
                                 word_of(file.encoding)));
  }
  if (is_unsigned && (file.encoding == Encoding::signed_float || file.encoding == Encoding::slope)) {
    throw UsageError(fmt::format("{}: has {}, which hold no negative numbers; encoding {} needs float pixels",
                                 file.path, describe(pixels), word_of(file.encoding)));
  }
  return file.encoding;
}

/// The step between slopes that the pixels can hold: near the flat normal for integers, at values between 0.5
/// and 1 for half floats. 0: too fine to matter.
double slope_step(const MapFile& file, Encoding encoding, const MapPixels& pixels) {
  if (pixels.bits > 16) return 0;
  const int magnitude_bits = pixels.type == MapPixels::Type::signed_integer ? pixels.bits - 1 : pixels.bits;
  const double step =
      pixels.type == MapPixels::Type::floating ? std::exp2(-11) : 1 / (std::exp2(magnitude_bits) - 1);
  if (encoding == Encoding::height) return step * std::abs(file.height_scale) / 2;  // central differences
  return encoding == Encoding::unorm ? 2 * step : step;
}

/// Says below which roughness the P-NDF falls apart into one spike a step.
void report_quantisation(const MapFile& file, Encoding encoding, const MapPixels& pixels,
                         SurfaceReport& report) {
  const double step = slope_step(file, encoding, pixels);
  if (step == 0) return;
  const std::string text = fmt::format(
      "{} hold slopes in steps of {:.2g}; a roughness below that shows the steps, not the surface",
      describe(pixels), step);
  const std::string losses = pixels.is_lossy ? fmt::format(", and {} has losses besides", pixels.format) : "";
  (pixels.bits <= 8 || pixels.is_lossy ? report.warnings : report.notes).push_back(text + losses);
}

/// How many texels something happened to, and where first.
struct Tally {
  std::size_t count = 0, first = 0;

  void add(std::size_t texel) {
    if (count++ == 0) first = texel;
  }
  /// "12 of 256 texels (the first at column 3, row 4 of the image)", counted from its top left
  std::string text(const MapPixels& pixels) const {
    const auto width = static_cast<std::size_t>(pixels.width),
               height = static_cast<std::size_t>(pixels.height);
    return fmt::format("{} of {} texels (the first at column {}, row {} of the image)", count, width * height,
                       first % width, height - 1 - first / width);
  }
};

/// Turns texels into normals one by one and counts what is wrong with them.
class Decoder {
 public:
  Decoder(const MapFile& file, Encoding encoding, const MapPixels& pixels, SurfaceReport& report)
      : file_(file),
        encoding_(encoding),
        pixels_(pixels),
        channels_(static_cast<int>(pixels.channels.size())),
        report_(report) {
    if (third_says_nothing(pixels, encoding)) {
      channels_ = 2;
      report.notes.push_back(fmt::format("{} is {:g} everywhere: taken as a map of two channels, {} and {}",
                                         pixels.channels[2], pixels.pixels[2], pixels.channels[0],
                                         pixels.channels[1]));
    }
    valid_.assign(static_cast<std::size_t>(pixels.width) * pixels.height, true);
  }

  std::vector<Eigen::Vector2d> decode() {
    std::vector<Eigen::Vector2d> normals(valid_.size(), Eigen::Vector2d::Zero());
    if (encoding_ == Encoding::height) {
      const std::vector<double> heights = decode_heights();
      for (std::size_t texel = 0; texel < normals.size(); ++texel)
        normals[texel] = from_heights(heights, texel);
    } else {
      for (std::size_t texel = 0; texel < normals.size(); ++texel) normals[texel] = decode_texel(texel);
      repair(normals);
    }
    report_counts();
    return normals;
  }

 private:
  double value(std::size_t texel, int channel) const { return pixels_.value(texel, channel); }

  Eigen::Vector2d invalid(std::size_t texel) {
    valid_[texel] = false;
    invalid_.add(texel);
    return Eigen::Vector2d::Zero();
  }

  Eigen::Vector2d on_rim(std::size_t texel, const Eigen::Vector2d& direction) {
    if (direction.isZero(0)) return invalid(texel);  // straight down: no direction to lean to
    beyond_rim_.add(texel);
    return kRim * direction.normalized();
  }

  Eigen::Vector2d on_disk(std::size_t texel, const Eigen::Vector2d& s) {
    return s.norm() > kRim ? on_rim(texel, s) : s;
  }

  Eigen::Vector2d decode_texel(std::size_t texel) {
    Eigen::Vector3d n = Eigen::Vector3d::Zero();
    for (int channel = 0; channel < channels_; ++channel) n[channel] = value(texel, channel);
    if (!n.head(channels_).allFinite()) return invalid(texel);
    if (encoding_ == Encoding::unorm) n = 2 * n - Eigen::Vector3d::Ones();
    if (file_.green == GreenDirection::down) n.y() = -n.y();
    if (encoding_ == Encoding::slope) return on_disk(texel, disk_from_slope(n.head<2>()));
    if (channels_ == 2) return on_disk(texel, n.head<2>());

    const double length = n.norm();
    if (length < kShortestNormal) return invalid(texel);
    if (std::abs(length - 1) > length_tolerance()) unnormalised_.add(texel);
    if (!keeps_rounded(length)) n /= length;
    return n.z() > 0 ? on_disk(texel, n.head<2>()) : on_rim(texel, n.head<2>());
  }

  std::vector<double> decode_heights() {
    std::vector<double> heights(valid_.size());
    for (std::size_t texel = 0; texel < heights.size(); ++texel) {
      heights[texel] = file_.height_scale * value(texel, 0);
      if (!std::isfinite(heights[texel])) invalid(texel);
    }
    repair(heights);
    return heights;
  }

  Eigen::Vector2d from_heights(const std::vector<double>& heights, std::size_t texel) {
    const auto width = static_cast<std::size_t>(pixels_.width),
               height = static_cast<std::size_t>(pixels_.height);
    const std::size_t i = texel % width, j = texel / width;
    const auto at = [&](std::size_t x, std::size_t y) { return heights[y % height * width + x % width]; };
    return on_disk(texel, disk_from_slope({(at(i + 1, j) - at(i + width - 1, j)) / 2,  //
                                           (at(i, j + 1) - at(i, j + height - 1)) / 2}));
  }

  /// What is restored is known within half a step as it is in the file; scaling would add the third
  /// coordinate's rounding.
  bool keeps_rounded(double length) const {
    return file_.precision == Precision::restore &&
           std::abs(length - 1) <= std::sqrt(0.75) * slope_step(file_, encoding_, pixels_);
  }

  double length_tolerance() const {
    const bool is_coarse = pixels_.bits <= 8 && pixels_.type != MapPixels::Type::floating;
    return is_coarse ? 0.03 : 0.01;  // rounding to 8 bits alone moves a length by up to 0.7%
  }

  template <typename T>
  void repair(std::vector<T>& values) {
    if (invalid_.count == 0) return;
    const std::string found =
        fmt::format("NaN, infinite or zero-length values in {}", invalid_.text(pixels_));
    if (file_.invalid == TexelRepair::refuse) throw FileError(file_.path + ": " + found);
    if (invalid_.count == values.size())
      throw FileError(file_.path + ": " + found + ": nothing to repair them from");
    fill_holes(pixels_.width, pixels_.height, valid_, values);
    report_.warnings.push_back(found + ": filled with the mean of their valid neighbours");
  }

  void report_counts() {
    const auto hint = [&](const Tally& tally) {
      return 2 * tally.count > valid_.size() ? "; most of the map: is the encoding right?" : "";
    };
    if (unnormalised_.count > 0) {
      report_.warnings.push_back(
          fmt::format("normals were scaled to length 1 that were more than {:g}% off in {}{}",
                      100 * length_tolerance(), unnormalised_.text(pixels_), hint(unnormalised_)));
    }
    if (beyond_rim_.count > 0) {
      report_.warnings.push_back(fmt::format(
          "normals that point below the surface or beyond |s| = {} were moved to that rim in {}{}", kRim,
          beyond_rim_.text(pixels_), hint(beyond_rim_)));
    }
  }

  const MapFile& file_;
  Encoding encoding_;
  const MapPixels& pixels_;
  int channels_;  // that are used
  SurfaceReport& report_;
  std::vector<bool> valid_;
  Tally invalid_, unnormalised_, beyond_rim_;
};

/// The step whose rounding has the variance that the half floats' has on average.
double mean_step(const std::vector<Eigen::Vector2d>& normals, Encoding encoding) {
  const double scale = encoding == Encoding::unorm ? 2 : 1, middle = scale - 1;
  double squares = 0;
  for (const Eigen::Vector2d& s : normals)
    for (const double n : s) squares += std::pow(scale * half_float_step((n + middle) / scale), 2);
  return std::sqrt(squares / (2 * static_cast<double>(normals.size())));
}

/// What the file tells of normals, of those that it gave.
Surface::Steps steps_of(const MapFile& file, Encoding encoding, const MapPixels& pixels,
                        const std::vector<Eigen::Vector2d>& normals) {
  Surface::Steps steps;
  steps.step = slope_step(file, encoding, pixels);
  steps.widens = file.precision == Precision::widen;
  const bool of_normals = encoding == Encoding::unorm || encoding == Encoding::signed_float;
  if (of_normals && pixels.channels.size() == 3) steps.third = static_cast<float>(steps.step);
  if (steps.step > 0 && encoding != Encoding::height && pixels.type == MapPixels::Type::floating) {
    steps.step = mean_step(normals, encoding);
    steps.halves = encoding != Encoding::unorm;
  }
  return steps;
}

}  // namespace

std::vector<Eigen::Vector2d> decode_normals(const MapFile& file, const MapPixels& pixels,
                                            SurfaceReport& report, Surface::Steps* steps) {
  if (!std::isfinite(file.height_scale)) {
    throw UsageError(
        fmt::format("{}: height_scale is {}, expected a finite number", file.path, file.height_scale));
  }
  const Encoding encoding = choose_encoding(file, pixels, report);
  if (encoding == Encoding::height && file.green == GreenDirection::down) {
    report.warnings.push_back("green = \"down\" has no effect on a height map");
  }
  report_quantisation(file, encoding, pixels, report);
  if (encoding == Encoding::height && file.precision == Precision::restore)
    throw UsageError(file.path + ": precision \"restore\" is for normals; found heights");
  std::vector<Eigen::Vector2d> normals = Decoder(file, encoding, pixels, report).decode();
  if (steps != nullptr) *steps = steps_of(file, encoding, pixels, normals);
  return normals;
}

Surface load_map(const MapFile& file, Interpolation interpolation, SurfaceReport& report) {
  const MapPixels pixels = read_map_pixels(file.path, report, file.choice);
  Surface::Steps steps;
  std::vector<Eigen::Vector2d> normals = decode_normals(file, pixels, report, &steps);
  const bool restores = file.precision == Precision::restore && steps.step > 0;
  if (restores) {
    restore_normals(pixels.width, pixels.height, steps.step, &normals);
    report.notes.push_back(
        fmt::format("normals restored between steps of {:.2g} where their neighbours tell", steps.step));
  }
  Surface surface(pixels.width, pixels.height, interpolation, std::move(normals));
  if (!restores) surface.note_steps(steps);  // of what is left after that no number is known
  return surface;
}

}  // namespace mica::host
