#include "mica/evaluator.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "host/base/chunks.h"
#include "host/library/query.h"
#include "host/library/settings.h"
#include "host/library/subject.h"
#include "host/library/work.h"
#include "host/methods/draw_images.h"
#include "host/methods/evaluator.h"

MICA_BEGIN_NAMESPACE

class Evaluator::Implementation {
 public:
  Implementation(const Device& device, std::shared_ptr<const host::Surface> surface, const std::string& name,
                 const Settings& settings, const Methods& methods)
      : subject_(device, std::move(surface), name, methods),
        evaluator_(subject_.method().make(subject_.device(), subject_.surface(),
                                          *host::method_settings(subject_.method(), settings))) {}

  /// D of all queries, `take(first, densities)` by chunks, after all were found to have an answer.
  template <typename Take>
  void evaluate(const Queries& queries, const RunControl& control, const Take& take) {
    const std::lock_guard<std::mutex> lock(mutex_);
    host::check_columns(queries);
    subject_.check(queries.count, [&](std::size_t n) { return host::to_query(queries, n); });
    calibrate_once(queries);
    std::vector<host::Query> some;
    const auto answer = [&](std::size_t first, std::size_t count) {
      some.resize(count);
      tbb::parallel_for(std::size_t{0}, count,
                        [&](std::size_t n) { some[n] = host::to_query(queries, first + n); });
      take(first, evaluator_->evaluate(some));
    };
    host::work_in_chunks(queries.count, answer,
                         [&](std::size_t done) { host::report(control, done, queries.count); });
  }

  void estimate_errors(const Queries& queries, Span<const float> densities, Span<float> errors);

  void draw(const Footprints& footprints, const Column& roughness, const host::ImageWindow& window,
            Span<float> images, const RunControl& control);

  host::Evaluator& evaluator() { return *evaluator_; }

 private:
  void calibrate_once(const Queries& queries) {
    if (calibrated_ || queries.count == 0) return;
    evaluator_->calibrate(
        queries.count, [&](std::size_t n) { return host::to_query(queries, n); }, 1);
    calibrated_ = true;
  }

  std::mutex mutex_;
  host::Subject subject_;
  std::unique_ptr<host::Evaluator> evaluator_;  // goes before what it stands on
  bool calibrated_ = false;
};

void Evaluator::Implementation::estimate_errors(const Queries& queries, Span<const float> densities,
                                                Span<float> errors) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!subject_.method().traits().estimates_errors)
    throw UsageError(fmt::format("{} does not tell how far its answers may be off", evaluator_->name()));
  host::check_columns(queries);
  subject_.check(queries.count, [&](std::size_t n) { return host::to_query(queries, n); });
  for (std::size_t n = 0; n < queries.count; ++n)
    errors[n] = static_cast<float>(evaluator_->error_estimate(host::to_query(queries, n), densities[n]));
}

void Evaluator::Implementation::draw(const Footprints& footprints, const Column& roughness,
                                     const host::ImageWindow& window, Span<float> images,
                                     const RunControl& control) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto footprint = [&](std::size_t n) {
    return host::Query{host::to_footprint(footprints, n), Eigen::Vector2d::Zero(), roughness[n]};
  };
  subject_.check(footprints.count, footprint);
  const std::vector<float> drawn =
      host::draw_images(*evaluator_, footprints.count, footprint, window,
                        [&](std::size_t done) { host::report(control, done, footprints.count); });
  calibrated_ = true;
  std::copy(drawn.begin(), drawn.end(), images.data);
}

Evaluator::Evaluator(const Device& device, const NormalMap& map, const std::string& method,
                     const Settings& settings, const Methods& methods)
    : implementation_(
          std::make_shared<Implementation>(device, map.implementation(), method, settings, methods)) {}

Evaluator::Evaluator(const Device& device, const std::string& method, const Settings& settings,
                     const Methods& methods)
    : implementation_(std::make_shared<Implementation>(device, nullptr, method, settings, methods)) {}

void Evaluator::evaluate(const Queries& queries, Span<float> densities, const RunControl& control) const {
  host::check_room(queries.count, densities, "densities");
  host::opened(implementation_)
      .evaluate(queries, control, [&](std::size_t first, const std::vector<float>& some) {
        std::copy(some.begin(), some.end(), densities.data + first);
      });
}

void Evaluator::evaluate(const Queries& queries, Span<double> densities, const RunControl& control) const {
  host::check_room(queries.count, densities, "densities");
  host::opened(implementation_)
      .evaluate(queries, control, [&](std::size_t first, const std::vector<float>& some) {
        std::copy(some.begin(), some.end(), densities.data + first);
      });
}

std::vector<float> Evaluator::evaluate(const Queries& queries, const RunControl& control) const {
  std::vector<float> densities(queries.count);
  evaluate(queries, Span<float>(densities), control);
  return densities;
}

void Evaluator::estimate_errors(const Queries& queries, Span<const float> densities,
                                Span<float> errors) const {
  host::check_room(queries.count, densities, "densities");
  host::check_room(queries.count, errors, "errors");
  host::opened(implementation_).estimate_errors(queries, densities, errors);
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
  host::check_room(footprints.count * inside.count(), images, "images");
  host::opened(implementation_).draw(footprints, roughness, inside, images, control);
}

std::string Evaluator::method() const {
  return host::opened(implementation_).evaluator().name();
}

std::vector<std::string> Evaluator::choices() const {
  std::vector<std::string> lines;
  for (const host::AutoChoice& choice : host::opened(implementation_).evaluator().choices())
    lines.push_back(host::words(choice));
  return lines;
}

std::size_t Evaluator::device_bytes() const {
  return host::opened(implementation_).evaluator().device_bytes();
}

double Evaluator::build_seconds() const {
  return host::opened(implementation_).evaluator().build_seconds();
}

double Evaluator::device_seconds() const {
  return host::opened(implementation_).evaluator().device_seconds();
}

MICA_END_NAMESPACE
