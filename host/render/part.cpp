#include "host/render/part.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <sstream>

#include "mica/error.h"

namespace mica::host {
namespace {

constexpr char kAudit[] = "mica:audit", kDevice[] = "mica:device";
constexpr char kPictureAudit[] = "mica:audit.picture", kPixels[] = "mica:audit_pixels";
constexpr char kSamples[] = "mica:audit_samples", kExposure[] = "mica:exposure", kToneMap[] = "mica:tone_map";

template <typename To, typename From>
To same_bits(From value) {
  static_assert(sizeof(To) == sizeof(From));
  To bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// How many the whole picture audits, and those of these rows: key, density and reference, as their bits.
std::string write_samples(int most, const std::vector<AuditedSample>& samples) {
  std::string text = fmt::format("{}", most);
  for (const AuditedSample& sample : samples)
    text += fmt::format(" {:x} {:x} {:x}", sample.key, same_bits<std::uint32_t>(sample.density),
                        same_bits<std::uint64_t>(sample.reference));
  return text;
}

/// @return how many the whole picture audits.
std::size_t read_samples(const std::string& text, std::vector<AuditedSample>* samples) {
  std::istringstream words(text);
  std::size_t most = 0;
  words >> most >> std::hex;
  std::uint64_t key = 0, reference = 0;
  for (std::uint32_t density = 0; words >> key >> density >> reference;)
    samples->push_back({key, same_bits<float>(density), same_bits<double>(reference)});
  return most;
}

/// The numbers of each audited pixel.
template <typename Pixels>
auto numbers_of(Pixels* pixels) {
  return std::array{&pixels->shown, &pixels->expected, &pixels->own, &pixels->exact,
                    &pixels->under_its_lamps};
}

/// The audited pixels of these rows: subpixels, the reference's L2, and all numbers of each.
std::string write_pixels(const AuditedPixels& pixels) {
  std::string text = fmt::format("{} {:x}", pixels.subpixels, same_bits<std::uint64_t>(pixels.reference_l2));
  for (std::size_t n = 0; n < pixels.shown.size(); ++n)
    for (const std::vector<float>* numbers : numbers_of(&pixels))
      text += fmt::format(" {:x}", same_bits<std::uint32_t>((*numbers)[n]));
  return text;
}

/// Adds those of a part.
void read_pixels(const std::string& text, AuditedPixels* pixels) {
  std::istringstream words(text);
  int subpixels = 0;
  std::uint64_t reference_l2 = 0;
  words >> subpixels >> std::hex >> reference_l2;
  pixels->subpixels = std::max(pixels->subpixels, subpixels);
  pixels->reference_l2 = std::max(pixels->reference_l2, same_bits<double>(reference_l2));
  const auto all = numbers_of(pixels);
  std::uint32_t number = 0;
  for (std::size_t n = 0; words >> number; ++n) all[n % all.size()]->push_back(same_bits<float>(number));
}

bool is_part(const Image& image) {
  for (const char* name : {kSamples, kPixels, kExposure, kToneMap})
    if (!image.metadata.count(name)) return false;
  return true;
}

/// Attributes that all parts of a picture have in common.
std::map<std::string, std::string> identity(const PicturePart& part) {
  std::map<std::string, std::string> identity = part.image.metadata;
  for (const char* name : {kDevice, kSamples, kPixels}) identity.erase(name);
  identity["size"] = fmt::format("{} x {}", part.image.width, part.image.whole_height);
  identity["channels"] = fmt::format("{}", fmt::join(part.image.channels, " "));
  return identity;
}

/// The first thing in which two identities differ: "mica:frame is 3 instead of 2".
std::string difference(const std::map<std::string, std::string>& found,
                       const std::map<std::string, std::string>& expected) {
  const auto value = [](const std::map<std::string, std::string>& all, const std::string& name) {
    const auto place = all.find(name);
    return place == all.end() ? std::string("nothing") : place->second;
  };
  std::set<std::string> names;
  for (const auto* all : {&found, &expected})
    for (const auto& [name, text] : *all) names.insert(name);
  for (const std::string& name : names)
    if (value(found, name) != value(expected, name))
      return fmt::format("{} is {} instead of {}", name, value(found, name), value(expected, name));
  return {};
}

/// The identity that most parts have: one foreign part must not make strangers of all others.
std::map<std::string, std::string> common_identity(const std::vector<PicturePart>& parts) {
  std::map<std::map<std::string, std::string>, int> counts;
  for (const PicturePart& part : parts) ++counts[identity(part)];
  return std::max_element(counts.begin(), counts.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

std::string rows(int first, int end) {
  return end - first == 1 ? fmt::format("row {}", first) : fmt::format("rows {}-{}", first, end - 1);
}

/// What is wrong with the rows of parts in their order; each from 0 to `height` has to be there once.
void check_rows(const std::vector<PicturePart>& parts, int height, std::vector<std::string>* problems) {
  int next = 0;
  const PicturePart* before = nullptr;
  for (const PicturePart& part : parts) {
    const int first = part.image.first_row, end = first + part.image.height;
    if (first > next) problems->push_back(fmt::format("{} are in no part", rows(next, first)));
    if (first < next)
      problems->push_back(
          fmt::format("{}: {} are in {} as well", part.path, rows(first, std::min(end, next)), before->path));
    if (end > next) next = end, before = &part;
  }
  if (next < height) problems->push_back(fmt::format("{} are in no part", rows(next, height)));
}

void check(std::vector<PicturePart>* parts) {
  std::vector<std::string> problems;
  const auto leave_out = [&](const auto& problem_of) {
    const auto is_wrong = [&](const PicturePart& part) {
      const std::string problem = problem_of(part);
      if (!problem.empty()) problems.push_back(fmt::format("{}: {}", part.path, problem));
      return !problem.empty();
    };
    parts->erase(std::remove_if(parts->begin(), parts->end(), is_wrong), parts->end());
  };
  leave_out([](const PicturePart& part) { return is_part(part.image) ? "" : "is no part of a picture"; });
  if (!parts->empty()) {
    const auto expected = common_identity(*parts);
    leave_out([&](const PicturePart& part) {
      const std::string other = difference(identity(part), expected);
      return other.empty() ? other : "is a part of another picture: " + other;
    });
    std::stable_sort(parts->begin(), parts->end(), [](const PicturePart& a, const PicturePart& b) {
      return a.image.first_row < b.image.first_row;
    });
    check_rows(*parts, parts->front().image.whole_height, &problems);
  }
  if (parts->empty() && problems.empty()) problems.emplace_back("found no part");
  if (!problems.empty()) throw UsageError(fmt::format("cannot join: {}", fmt::join(problems, "\n  ")));
}

}  // namespace

void make_part(const Job& job, RenderResult* result) {
  std::map<std::string, std::string>& metadata = result->image.metadata;
  metadata.erase(kAudit), metadata.erase(kPictureAudit);
  metadata[kSamples] = write_samples(job.audit.samples, result->audited);
  metadata[kPixels] = write_pixels(result->audited_pixels);
  metadata[kExposure] = fmt::format("{}", job.image.exposure);
  metadata[kToneMap] = word_of(job.image.tone_map);
}

JoinedPicture join(std::vector<PicturePart> parts) {
  check(&parts);
  JoinedPicture joined;
  Image& whole = joined.image;
  std::vector<AuditedSample> samples;
  AuditedPixels pixels;
  std::size_t most = 0;
  std::set<std::string> devices;
  for (const PicturePart& part : parts) {
    whole.pixels.insert(whole.pixels.end(), part.image.pixels.begin(), part.image.pixels.end());
    most = read_samples(part.image.metadata.at(kSamples), &samples);
    read_pixels(part.image.metadata.at(kPixels), &pixels);
    if (const auto device = part.image.metadata.find(kDevice); device != part.image.metadata.end())
      devices.insert(device->second);
  }
  const Image& first = parts.front().image;
  whole.width = first.width, whole.height = whole.whole_height = first.whole_height;
  whole.channels = first.channels, whole.metadata = first.metadata;
  joined.exposure = std::stod(whole.metadata.at(kExposure));
  joined.tone_map = parse_word<ToneMap>(whole.metadata.at(kToneMap)).value_or(ToneMap::shoulder);
  for (const char* name : {kSamples, kPixels, kExposure, kToneMap}) whole.metadata.erase(name);
  whole.metadata[kDevice] = fmt::format("{}", fmt::join(devices, "; "));
  std::sort(samples.begin(), samples.end(),
            [](const AuditedSample& a, const AuditedSample& b) { return a.key < b.key; });
  samples.resize(std::min(samples.size(), most));
  if (!samples.empty()) whole.metadata[kAudit] = describe(audit_result(samples));
  if (const PictureAudit audit = picture_audit(pixels); audit.pixels)
    whole.metadata[kPictureAudit] = describe(audit);
  return joined;
}

}  // namespace mica::host
