#include "host/methods/shared_evaluator.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <numeric>
#include <thread>

#include "host/device/device.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr std::size_t kLeastPiece = 256;     // queries: less would not fill a device
constexpr std::size_t kMostPiece = 1 << 17;  // that a launch takes
constexpr std::size_t kPiecesADevice = 4;    // so that a slow device is waited for a fourth of its share

std::size_t piece_of(std::size_t queries, std::size_t devices) {
  const std::size_t pieces = kPiecesADevice * devices;
  return std::clamp((queries + pieces - 1) / pieces, kLeastPiece, kMostPiece);
}

}  // namespace

/// Several batches may be under way; an evaluator works on one piece at a time.
struct SharedEvaluator::Part {
  DeviceShare share;
  std::mutex busy;
};

class SharedEvaluator::Densities : public PendingDensities {
 public:
  Densities(const std::vector<std::unique_ptr<Part>>& parts, std::vector<Query> queries,
            std::vector<GlintPoint> points)
      : queries_(std::move(queries)),
        points_(std::move(points)),
        piece_(piece_of(queries_.size(), parts.size())),
        densities_(queries_.size()),
        pieces_((queries_.size() + piece_ - 1) / piece_) {
    failed_.resize(parts.size());
    for (std::size_t n = 0; n < std::min(parts.size(), pieces_.size()); ++n)
      threads_.emplace_back([this, part = parts[n].get(), error = &failed_[n]] { work(part, error); });
  }
  ~Densities() override {
    next_ = pieces_.size();
    join();
  }
  Densities(const Densities&) = delete;
  Densities& operator=(const Densities&) = delete;

  std::vector<float> wait() override {
    join();
    for (const std::exception_ptr& error : failed_)
      if (error) std::rethrow_exception(error);
    return std::move(densities_);
  }
  float density_of_color(std::size_t color, std::size_t query) const override {
    return pieces_[query / piece_]->density_of_color(color, query % piece_);
  }

 private:
  /// Takes pieces until there are none. When one fails, nobody takes another.
  void work(Part* part, std::exception_ptr* error) {
    try {
      for (std::size_t n = next_++; n < pieces_.size(); n = next_++) evaluate(n, part);
    } catch (const DeviceError& failure) {
      next_ = pieces_.size();
      *error =
          std::make_exception_ptr(DeviceError(fmt::format("{}: {}", part->share.device, failure.what())));
    } catch (...) {
      next_ = pieces_.size();
      *error = std::current_exception();
    }
  }

  void evaluate(std::size_t n, Part* part) {
    const std::size_t first = n * piece_, end = std::min(first + piece_, queries_.size());
    const auto of = [&](const auto& all) {
      return std::decay_t<decltype(all)>(all.begin() + static_cast<std::ptrdiff_t>(first),
                                         all.begin() + static_cast<std::ptrdiff_t>(end));
    };
    const std::lock_guard<std::mutex> lock(part->busy);
    Evaluator& evaluator = *part->share.evaluator;
    pieces_[n] =
        points_.empty() ? evaluator.start(of(queries_)) : evaluator.start_at(of(queries_), of(points_));
    const std::vector<float> answers = pieces_[n]->wait();
    if (points_.empty()) pieces_[n].reset();  // nobody asks for colours
    std::copy(answers.begin(), answers.end(), densities_.begin() + static_cast<std::ptrdiff_t>(first));
  }

  void join() {
    for (std::thread& thread : threads_)
      if (thread.joinable()) thread.join();
  }

  const std::vector<Query> queries_;
  const std::vector<GlintPoint> points_;  // none: queries alone
  const std::size_t piece_;               // queries of each but the last
  std::vector<float> densities_;
  std::vector<std::unique_ptr<PendingDensities>> pieces_;
  std::vector<std::exception_ptr> failed_;  // by thread
  std::atomic<std::size_t> next_{0};
  std::vector<std::thread> threads_;
};

SharedEvaluator::SharedEvaluator(std::vector<DeviceShare> shares) {
  for (DeviceShare& share : shares) {
    parts_.push_back(std::make_unique<Part>());
    parts_.back()->share = std::move(share);
  }
}

SharedEvaluator::~SharedEvaluator() = default;

std::unique_ptr<PendingDensities> SharedEvaluator::start(const std::vector<Query>& queries) {
  return std::make_unique<Densities>(parts_, queries, std::vector<GlintPoint>());
}

std::unique_ptr<PendingDensities> SharedEvaluator::start_at(const std::vector<Query>& queries,
                                                            const std::vector<GlintPoint>& points) {
  return std::make_unique<Densities>(parts_, queries, points);
}

void SharedEvaluator::calibrate(std::size_t count, const QuerySource& query, double scale) {
  for (const auto& part : parts_) part->share.evaluator->calibrate(count, query, scale);
}

std::vector<AutoChoice> SharedEvaluator::choices() const {
  return parts_.front()->share.evaluator->choices();
}

double SharedEvaluator::error_estimate(const Query& query, double density) const {
  return parts_.front()->share.evaluator->error_estimate(query, density);
}

std::size_t SharedEvaluator::replaced() const {
  std::size_t count = 0;
  for (const auto& part : parts_) {
    const std::lock_guard<std::mutex> lock(part->busy);  // it counts as it works
    count += part->share.evaluator->replaced();
  }
  return count;
}

std::string SharedEvaluator::name() const {
  return parts_.front()->share.evaluator->name();
}

std::size_t SharedEvaluator::device_bytes() const {
  std::size_t bytes = 0;
  for (const auto& part : parts_) bytes += part->share.evaluator->device_bytes();
  return bytes;
}

double SharedEvaluator::build_seconds() const {
  double seconds = 0;
  for (const auto& part : parts_) seconds += part->share.evaluator->build_seconds();
  return seconds;
}

double SharedEvaluator::device_seconds() const {
  double seconds = 0;
  for (const auto& part : parts_) {
    const std::lock_guard<std::mutex> lock(part->busy);
    seconds += part->share.evaluator->device_seconds();
  }
  return seconds;
}

std::unique_ptr<Evaluator> make_on(const std::vector<Device*>& devices, const Method& method,
                                   const Surface* surface, const MethodSettings& settings) {
  if (devices.size() == 1) return method.make(devices.front(), surface, settings);
  std::vector<DeviceShare> shares;
  for (std::size_t n = 0; n < devices.size(); ++n) {
    const std::string name =
        fmt::format("device {} of {}, {}", n + 1, devices.size(), devices[n]->info().name);
    try {
      shares.push_back({name, method.make(devices[n], surface, settings)});
    } catch (const DeviceError& error) {
      throw DeviceError(fmt::format("{}: {}", name, error.what()));
    }
  }
  return std::make_unique<SharedEvaluator>(std::move(shares));
}

}  // namespace mica::host
