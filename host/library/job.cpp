#include "mica/job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <optional>

#include "host/device/device.h"
#include "host/image/image.h"
#include "host/job/job.h"
#include "host/job/read_job.h"
#include "host/library/subject.h"
#include "host/render/render.h"
#include "mica/error.h"

MICA_BEGIN_NAMESPACE

std::vector<float> Image::channel(const std::string& name) const {
  const auto found = std::find(channels.begin(), channels.end(), name);
  if (found == channels.end())
    throw UsageError(fmt::format("channel \"{}\": the image has {}", name, fmt::join(channels, ", ")));
  const auto place = static_cast<std::size_t>(found - channels.begin());
  std::vector<float> values(pixels.size() / channels.size());
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = pixels[n * channels.size() + place];
  return values;
}

namespace {

host::ToneMap tone_map_of(const Image& image) {
  const std::optional<host::ToneMap> found = host::parse_word<host::ToneMap>(image.tone_map);
  if (!found)
    throw UsageError(fmt::format("tone map \"{}\": expected {}", image.tone_map,
                                 fmt::join(host::list_words<host::ToneMap>(), ", ")));
  return *found;
}

}  // namespace

void write(const Image& image, const std::string& path, double exposure_stops) {
  host::Image inside;
  inside.width = image.width, inside.height = image.height;
  inside.channels = image.channels, inside.pixels = image.pixels;
  inside.metadata = image.metadata;
  const std::size_t expected = image.channels.size() * static_cast<std::size_t>(std::max(image.width, 0)) *
                               static_cast<std::size_t>(std::max(image.height, 0));
  if (expected == 0 || image.pixels.size() != expected)
    throw UsageError(fmt::format("image of {} x {} and {} channels: found {} numbers; expected {}",
                                 image.width, image.height, image.channels.size(), image.pixels.size(),
                                 expected));
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".exr")
    host::write_exr(path, inside);
  else if (ending == ".png")
    host::write_png(path, inside, image.exposure_stops + exposure_stops, tone_map_of(image));
  else
    throw UsageError(fmt::format("{}: expected a file name that ends in .exr or .png", path));
}

Job::Job(std::shared_ptr<const host::Job> job) : implementation_(std::move(job)) {}

Job Job::load(const std::string& path, const std::vector<std::string>& overrides, const Methods& methods) {
  return Job(std::make_shared<host::Job>(host::load_job(path, overrides, *methods.implementation())));
}

Job Job::parse(const std::string& text, const std::string& folder, const std::vector<std::string>& overrides,
               const Methods& methods) {
  const std::string path = (std::filesystem::path(folder) / "job.toml").string();
  return Job(std::make_shared<host::Job>(host::read_job(text, path, overrides, *methods.implementation())));
}

const std::shared_ptr<const host::Job>& Job::implementation() const {
  if (!implementation_) throw UsageError("job: found one that was moved from; expected a job");
  return implementation_;
}

int Job::width() const {
  return implementation()->image.width;
}

int Job::height() const {
  return implementation()->image.height;
}

int Job::first_frame() const {
  return implementation()->frames.first;
}

int Job::last_frame() const {
  return implementation()->frames.last;
}

std::string Job::plan() const {
  return host::describe(host::make_plan(*implementation()));
}

class Renderer::Implementation {
 public:
  Implementation(const Device& device, const Job& job)
      : device_(device.implementation()), job_(job.implementation()), plan_(host::make_plan(*job_)) {}

  Image render(std::optional<int> wanted, const RunControl& control) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const int frame = wanted.value_or(job_->frames.first);
    if (frame < job_->frames.first || frame > job_->frames.last)
      throw UsageError(
          fmt::format("frame {}: the job has frames {} to {}", frame, job_->frames.first, job_->frames.last));
    if (control.cancellation.is_cancelled()) throw Cancelled();
    if (!built_) built_.emplace(*job_, plan_, *device_);
    const auto progress = [&](int rows, int all) {
      if (control.cancellation.is_cancelled()) throw Cancelled();
      if (control.progress) control.progress(static_cast<std::size_t>(rows), static_cast<std::size_t>(all));
    };
    host::RenderResult result = host::render_frame(*built_, frame, device_->info(), progress);
    Image image;
    image.width = result.image.width, image.height = result.image.height;
    image.channels = std::move(result.image.channels), image.pixels = std::move(result.image.pixels);
    image.metadata = std::move(result.image.metadata);
    image.exposure_stops = job_->image.exposure, image.tone_map = host::word_of(job_->image.tone_map);
    image.notes = std::move(result.surface_notes);
    image.notes.insert(image.notes.end(), result.surface_warnings.begin(), result.surface_warnings.end());
    return image;
  }

 private:
  std::mutex mutex_;
  std::shared_ptr<host::Device> device_;
  std::shared_ptr<const host::Job> job_;
  host::Plan plan_;
  std::optional<host::BuiltJob> built_;  // goes before what it stands on
};

Renderer::Renderer(const Device& device, const Job& job)
    : implementation_(std::make_shared<Implementation>(device, job)) {}

Image Renderer::render(const RunControl& control) const {
  return host::opened(implementation_).render(std::nullopt, control);
}

Image Renderer::render(int frame, const RunControl& control) const {
  return host::opened(implementation_).render(frame, control);
}

MICA_END_NAMESPACE
