#include "mica/evaluator.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <mutex>

#include "host/device/device.h"
#include "host/library/query.h"
#include "host/library/settings.h"
#include "host/library/work.h"
#include "host/methods/evaluator.h"
#include "host/surface/surface.h"

MICA_BEGIN_NAMESPACE

class Evaluator::Implementation {
 public:
  Implementation(const Device& device, std::shared_ptr<const host::Surface> surface, const std::string& name,
                 const Settings& settings, const Methods& methods)
      : device_(device.implementation()),
        surface_(std::move(surface)),
        methods_(methods.implementation()),
        method_(methods_->get(name)) {
    if (method_.traits().map != (surface_ != nullptr))
      throw UsageError(
          fmt::format("{} {}", name, surface_ ? "needs no map; found one" : "needs a map; found none"));
    evaluator_ = method_.make(device_.get(), surface_.get(), *host::method_settings(method_, settings));
  }

  /// D of all queries, `take(first, densities)` by chunks, after all were found to have an answer.
  template <typename Take>
  void evaluate(const Queries& queries, const RunControl& control, const Take& take) {
    const std::lock_guard<std::mutex> lock(mutex_);
    host::check_columns(queries);
    check(queries);
    calibrate_once(queries);
    std::vector<host::Query> some;
    host::work_in_chunks(queries.count, control, [&](std::size_t first, std::size_t count) {
      some.resize(count);
      tbb::parallel_for(std::size_t{0}, count,
                        [&](std::size_t n) { some[n] = host::to_query(queries, first + n); });
      take(first, evaluator_->evaluate(some));
    });
  }

  void draw(const Footprints& footprints, const Column& roughness, const host::ImageWindow& window,
            Span<float> images, const RunControl& control);

  host::Evaluator& evaluator() { return *evaluator_; }
  std::mutex& mutex() { return mutex_; }

 private:
  void check(const Queries& queries) const {
    for (std::size_t n = 0; n < queries.count; ++n)
      host::refuse_query(n, method_.query_problem(host::to_query(queries, n), surface_.get()));
  }
  void calibrate_once(const Queries& queries) {
    if (calibrated_ || queries.count == 0) return;
    evaluator_->calibrate(
        queries.count, [&](std::size_t n) { return host::to_query(queries, n); }, 1);
    calibrated_ = true;
  }

  std::mutex mutex_;
  std::shared_ptr<host::Device> device_;
  std::shared_ptr<const host::Surface> surface_;
  std::shared_ptr<const host::MethodRegistry> methods_;
  const host::Method& method_;
  std::unique_ptr<host::Evaluator> evaluator_;  // goes before what it stands on
  bool calibrated_ = false;
};

/// By the method's own painter, or query by query.
void Evaluator::Implementation::draw(const Footprints& footprints, const Column& roughness,
                                     const host::ImageWindow& window, Span<float> images,
                                     const RunControl& control) {
  const auto footprint = [&](std::size_t n) {
    return host::Query{host::to_footprint(footprints, n), Eigen::Vector2d::Zero(), roughness[n]};
  };
  for (std::size_t n = 0; n < footprints.count; ++n)
    host::refuse_query(n, method_.query_problem(footprint(n), surface_.get()));
  std::fill(images.data, images.data + images.size, 0.0F);
  const std::unique_ptr<host::Painter> painter = evaluator_->painter(footprints.count, footprint, window);
  const std::vector<std::size_t> pixels = window.pixels_on_disk();
  for (std::size_t n = 0; n < footprints.count; ++n) {
    if (control.cancellation.is_cancelled()) throw Cancelled();
    float* const image = images.data + n * window.count();
    if (painter) {
      const std::vector<float> painted = painter->paint({footprint(n)}, window);
      std::copy(painted.begin(), painted.end(), image);
    } else {
      std::vector<host::Query> queries(pixels.size(), footprint(n));
      for (std::size_t k = 0; k < pixels.size(); ++k) queries[k].half_vector = window.half_vector(pixels[k]);
      const std::vector<float> densities = evaluator_->evaluate(queries);
      for (std::size_t k = 0; k < pixels.size(); ++k) image[pixels[k]] = densities[k];
    }
    if (control.progress) control.progress(n + 1, footprints.count);
  }
}

Evaluator::Evaluator(const Device& device, const NormalMap& map, const std::string& method,
                     const Settings& settings, const Methods& methods)
    : implementation_(
          std::make_shared<Implementation>(device, map.implementation(), method, settings, methods)) {}

Evaluator::Evaluator(const Device& device, const std::string& method, const Settings& settings,
                     const Methods& methods)
    : implementation_(std::make_shared<Implementation>(device, nullptr, method, settings, methods)) {}

namespace {

Evaluator::Implementation& opened(const std::shared_ptr<Evaluator::Implementation>& implementation) {
  if (!implementation)
    throw UsageError("evaluator: found one that was moved from; expected one with a method");
  return *implementation;
}

template <typename T>
void check_room(std::size_t expected, Span<T> room, const char* what) {
  if (room.size != expected || (room.data == nullptr && expected > 0))
    throw UsageError(fmt::format("{}: found room for {}; expected {}", what,
                                 room.data == nullptr ? 0 : room.size, expected));
}

}  // namespace

void Evaluator::evaluate(const Queries& queries, Span<float> densities, const RunControl& control) const {
  check_room(queries.count, densities, "densities");
  opened(implementation_).evaluate(queries, control, [&](std::size_t first, const std::vector<float>& some) {
    std::copy(some.begin(), some.end(), densities.data + first);
  });
}

void Evaluator::evaluate(const Queries& queries, Span<double> densities, const RunControl& control) const {
  check_room(queries.count, densities, "densities");
  opened(implementation_).evaluate(queries, control, [&](std::size_t first, const std::vector<float>& some) {
    std::copy(some.begin(), some.end(), densities.data + first);
  });
}

std::vector<float> Evaluator::evaluate(const Queries& queries, const RunControl& control) const {
  std::vector<float> densities(queries.count);
  evaluate(queries, Span<float>(densities), control);
  return densities;
}

void Evaluator::draw(const Footprints& footprints, const Column& roughness, const PndfWindow& window,
                     Span<float> images, const RunControl& control) const {
  if (window.pixels < 1 || window.pixels > 8192)
    throw UsageError(fmt::format("window: found {} pixels a side; expected 1 to 8192", window.pixels));
  if (!(window.radius > 0) || !std::isfinite(window.radius + window.center_s + window.center_t))
    throw UsageError("window: expected finite numbers and a positive radius");
  const host::ImageWindow inside{{window.center_s, window.center_t}, window.radius, window.pixels};
  host::check_columns(footprints);
  if (roughness.is_null()) throw UsageError("roughness: found no memory; expected numbers");
  check_room(footprints.count * inside.count(), images, "images");
  Implementation& implementation = opened(implementation_);
  const std::lock_guard<std::mutex> lock(implementation.mutex());
  implementation.draw(footprints, roughness, inside, images, control);
}

std::string Evaluator::method() const {
  return opened(implementation_).evaluator().name();
}

std::vector<std::string> Evaluator::choices() const {
  std::vector<std::string> lines;
  for (const host::AutoChoice& choice : opened(implementation_).evaluator().choices())
    lines.push_back(
        fmt::format("footprints of about {:.3g} texels, roughness from {:.3g}: {}; relative L2 {:.2g}, at "
                    "most {:.2g}",
                    std::exp2(choice.kind.size), 0.02 * std::exp2(0.5 * choice.kind.roughness),
                    choice.evaluator, choice.relative_l2, choice.upper_bound));
  return lines;
}

std::size_t Evaluator::device_bytes() const {
  return opened(implementation_).evaluator().device_bytes();
}

double Evaluator::build_seconds() const {
  return opened(implementation_).evaluator().build_seconds();
}

double Evaluator::device_seconds() const {
  return opened(implementation_).evaluator().device_seconds();
}

MICA_END_NAMESPACE
