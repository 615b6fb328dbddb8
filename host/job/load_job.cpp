#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

#include "host/job/read_job.h"
#include "host/job/toml_document.h"
#include "host/scene/aovs.h"
#include "host/scene/disk_cells.h"

namespace mica::host {
namespace {

constexpr std::size_t kLargestJob = 1 << 20;  // bytes

/// Stops soon after the largest size of a job, so that a device that never ends may be named.
std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const auto reason = [] { return std::generic_category().message(errno); };
  if (!file) throw FileError(fmt::format("{}: cannot be opened: {}", path, reason()));
  std::string text;
  std::vector<char> block(1 << 14);
  do {
    file.read(block.data(), std::streamsize(block.size()));
    text.append(block.data(), std::size_t(file.gcount()));
  } while (file && text.size() <= kLargestJob);
  if (file.bad()) throw FileError(fmt::format("{}: cannot be read: {}", path, reason()));
  return text;
}

toml::table parse_job(const std::string& text, const std::string& path, Issues& issues) {
  try {
    if (text.size() <= kLargestJob) return parse_toml(text, path);
    issues.add({{1, 1}, {1, 1}, nullptr},
               fmt::format("found more than {0} bytes; expected at most {0}", kLargestJob));
  } catch (const toml::parse_error& error) {
    issues.add(error.source(), printable(error.description()));
  }
  return {};
}

std::uint64_t hash_of(const std::string& text, const std::vector<std::string>& overrides) {
  std::string all = text;
  for (const std::string& item : overrides) all.append(1, '\0').append(item);  // neither can contain a NUL
  return XXH3_64bits(all.data(), all.size());
}

ImageSettings read_image(TableReader& table) {
  ImageSettings image;
  table.read("width", image.width, closed(1, 16384));
  table.read("height", image.height, closed(1, 16384));
  table.read("subpixels", image.subpixels, closed(1, 16));
  table.read("filter", image.filter.kind);
  table.read("filter_width", image.filter.width, closed(0.1, 8));
  if (image.filter.kind == FilterKind::subpixels && image.filter.width > 0)
    table.report("filter_width",
                 "found a width of the filter \"subpixels\"; expected one of a filter that has it");
  table.read("samples", image.samples, closed(1, 65536));
  table.read("max_bounces", image.max_bounces, closed(1, 64));
  std::vector<std::string_view> words;
  for (const Aov& aov : aovs()) words.push_back(aov.word);
  table.read("aovs", image.aovs, words);
  table.read("exposure", image.exposure, closed(-32, 32));
  table.read("tone_map", image.tone_map);
  return image;
}

FrameSettings read_frames(TableReader& table) {
  const Interval numbers = closed(0, 999999);
  FrameSettings frames;
  frames.given = true;
  Eigen::Vector2d range(0, 0);
  table.require("range", "the first and the last frame");
  table.read("range", range, numbers);
  if (range != range.array().round().matrix() || range[0] > range[1]) {
    table.report("range",
                 fmt::format("found [{}, {}]; expected two whole numbers, the first not above the last",
                             range[0], range[1]));
    return frames;
  }
  frames.first = static_cast<int>(range[0]), frames.last = static_cast<int>(range[1]);
  table.read("rate", frames.rate, closed(1e-3, 1e6));
  return frames;
}

/// The job's tolerance is for those who choose by it, unless the material has its own.
void give_tolerance(const Job& job, MaterialDescription* material) {
  if (!job.methods.get(material->ndf).traits().chooses || material->settings->tolerance) return;
  std::unique_ptr<MethodSettings> settings = material->settings->clone();
  settings->tolerance = job.accuracy.tolerance;
  material->settings = std::move(settings);
}

/// Tables that another renderer stands for.
void leave_out(TableReader& table) {
  const auto any = [](TableReader& left) { left.accept_any_key(); };
  for (const char* key : {"image", "frames", "camera", "background"}) table.read_table(key, any);
  for (const char* key : {"shape", "light"})
    if (table.has(key)) table.read_table_array(key, any);
}

void read_materials_of_layer(TableReader& table, Job& job) {
  job.scene.materials = read_materials(table, job.surfaces, job.methods);
  const auto has_id = [](const MaterialDescription& material) { return material.id.has_value(); };
  if (!std::any_of(job.scene.materials.begin(), job.scene.materials.end(), has_id))
    table.report("material",
                 "found no material with an id; expected `id = N`, the number that pixels of the "
                 "G-buffer have where it is");
}

void read_root(TableReader& table, Job& job, JobUse use) {
  table.read("seed", job.seed);
  if (use == JobUse::layer) {
    leave_out(table);
    job.surfaces = read_surfaces(table);
    read_materials_of_layer(table, job);
  } else {
    table.read_table("image", [&](TableReader& image) { job.image = read_image(image); });
    table.read_table("frames", [&](TableReader& frames) { job.frames = read_frames(frames); });
    job.surfaces = read_surfaces(table);
    job.scene = read_scene(table, job.surfaces, job.methods);
  }
  table.read_table("accuracy", [&](TableReader& accuracy) {
    accuracy.read("tolerance", job.accuracy.tolerance, closed(5e-4, 0.5));
    accuracy.read("lamp_parts", job.accuracy.lamp_parts, closed(1, kMostLampParts));
  });
  for (MaterialDescription& material : job.scene.materials) give_tolerance(job, &material);
  table.read_table("audit", [&](TableReader& audit) {
    audit.read("samples", job.audit.samples, closed(0, 1e6));
    audit.read("pixels", job.audit.pixels, closed(0, 4096));
  });
}

}  // namespace

Job load_job(const std::string& path, const std::vector<std::string>& overrides,
             const MethodRegistry& methods, std::uint64_t max_picture_bytes, JobUse use) {
  return read_job(read_text(path), path, overrides, methods, max_picture_bytes, use);
}

Job read_job(const std::string& text, const std::string& path, const std::vector<std::string>& overrides,
             const MethodRegistry& methods, std::uint64_t max_picture_bytes, JobUse use) {
  Issues issues(path);
  Job job;
  job.path = path;
  job.methods = methods;
  job.hash = hash_of(text, overrides);

  toml::table root = parse_job(text, path, issues);
  const bool parsed = issues.empty();
  for (const std::string& item : overrides) apply_override(root, item, issues);
  if (parsed) {
    ReadContext context{issues, std::filesystem::path(path).parent_path(), max_picture_bytes};
    TableReader::read_root(root, context, [&](TableReader& table) { read_root(table, job, use); });
  }
  issues.throw_if_any();
  return job;
}

}  // namespace mica::host
