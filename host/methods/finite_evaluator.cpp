#include "host/methods/finite_evaluator.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "host/reference/oracle.h"
#include "host/surface/surface.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// Replaces numbers that are not finite; built at the first of them.
class Substitute {
 public:
  Substitute(const Surface* surface, std::string method) : surface_(surface), method_(std::move(method)) {}

  /// @param query_of the query that a place asks. Not for several threads at a time.
  template <typename QueryOf>
  void repair(std::vector<float>* answers, const QueryOf& query_of) {
    std::vector<std::size_t> places;
    for (std::size_t n = 0; n < answers->size(); ++n)
      if (!std::isfinite((*answers)[n])) places.push_back(n);
    if (places.empty()) return;
    if (surface_ == nullptr)
      throw DeviceError(fmt::format("evaluating {}: a density is not finite", method_));
    std::vector<Query> queries;
    for (const std::size_t place : places) queries.push_back(query_of(place));
    if (!oracle_) oracle_.emplace(*surface_, kTolerance);
    const std::vector<reference::OracleResult> results = oracle_->evaluate(queries);
    for (std::size_t n = 0; n < places.size(); ++n)
      (*answers)[places[n]] = static_cast<float>(results[n].density);
    count_ += places.size();
  }
  std::size_t count() const { return count_; }

 private:
  static constexpr double kTolerance = 1e-7;  // as in single precision

  const Surface* surface_;
  std::string method_;
  std::optional<reference::Oracle> oracle_;
  std::atomic<std::size_t> count_ = 0;
};

class FiniteDensities : public PendingDensities {
 public:
  FiniteDensities(std::unique_ptr<PendingDensities> pending, const std::vector<Query>& queries,
                  std::shared_ptr<Substitute> substitute)
      : pending_(std::move(pending)), queries_(queries), substitute_(std::move(substitute)) {}

  std::vector<float> wait() override {
    std::vector<float> answers = pending_->wait();
    substitute_->repair(&answers, [this](std::size_t n) { return queries_[n]; });
    return answers;
  }
  float density_of_color(std::size_t color, std::size_t query) const override {
    return pending_->density_of_color(color, query);
  }

 private:
  std::unique_ptr<PendingDensities> pending_;
  std::vector<Query> queries_;
  std::shared_ptr<Substitute> substitute_;
};

class FinitePainter : public Painter {
 public:
  FinitePainter(std::unique_ptr<Painter> painter, std::shared_ptr<Substitute> substitute)
      : painter_(std::move(painter)), substitute_(std::move(substitute)) {}

  std::vector<float> paint(const std::vector<Query>& footprints, const ImageWindow& window) override {
    std::vector<float> images = painter_->paint(footprints, window);
    substitute_->repair(&images, [&](std::size_t n) {
      Query query = footprints[n / window.count()];
      query.half_vector = window.half_vector(n % window.count());
      return query;
    });
    return images;
  }

 private:
  std::unique_ptr<Painter> painter_;
  std::shared_ptr<Substitute> substitute_;
};

class FiniteEvaluator : public Evaluator {
 public:
  FiniteEvaluator(std::unique_ptr<Evaluator> evaluator, const Surface* surface)
      : evaluator_(std::move(evaluator)),
        variance_(surface ? surface->lobe_variance() : 0),
        substitute_(std::make_shared<Substitute>(surface, evaluator_->name())) {}

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override {
    if (variance_ == 0)
      return std::make_unique<FiniteDensities>(evaluator_->start(queries), queries, substitute_);
    std::vector<Query> wider(queries.size());
    std::transform(queries.begin(), queries.end(), wider.begin(),
                   [this](const Query& query) { return with_wider_lobe(query, variance_); });
    return std::make_unique<FiniteDensities>(evaluator_->start(wider), wider, substitute_);
  }
  std::unique_ptr<PendingDensities> start_at(const std::vector<Query>& queries,
                                             const std::vector<GlintPoint>& points) override {
    return std::make_unique<FiniteDensities>(evaluator_->start_at(queries, points), queries, substitute_);
  }
  void calibrate(std::size_t count, const QuerySource& query, double scale) override {
    evaluator_->calibrate(count, wider(query), scale);
  }
  std::vector<AutoChoice> choices() const override { return evaluator_->choices(); }
  std::unique_ptr<Painter> painter(std::size_t count, const QuerySource& footprint,
                                   const ImageWindow& window) override {
    if (variance_ > 0) return nullptr;  // it would be given footprints without wider lobes
    std::unique_ptr<Painter> painter = evaluator_->painter(count, footprint, window);
    return painter ? std::make_unique<FinitePainter>(std::move(painter), substitute_) : nullptr;
  }
  double error_estimate(const Query& query, double density) const override {
    return evaluator_->error_estimate(with_wider_lobe(query, variance_), density);
  }
  std::size_t replaced() const override { return substitute_->count() + evaluator_->replaced(); }
  std::string name() const override { return evaluator_->name(); }
  std::size_t device_bytes() const override { return evaluator_->device_bytes(); }
  double build_seconds() const override { return evaluator_->build_seconds(); }
  double device_seconds() const override { return evaluator_->device_seconds(); }

 private:
  QuerySource wider(const QuerySource& query) const {
    return [this, query](std::size_t n) { return with_wider_lobe(query(n), variance_); };
  }

  std::unique_ptr<Evaluator> evaluator_;
  double variance_;  // that lobes are wider by: Surface::lobe_variance
  std::shared_ptr<Substitute> substitute_;
};

}  // namespace

std::unique_ptr<Evaluator> with_finite_answers(std::unique_ptr<Evaluator> evaluator, const Surface* surface) {
  return std::make_unique<FiniteEvaluator>(std::move(evaluator), surface);
}

}  // namespace mica::host
