#include "host/render/pending_block.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace mica::host {

PendingBlock::PendingBlock(TracedRows rows, const BuiltJob& built)
    : PendingBlock(std::move(rows), built, built.evaluators()) {}

PendingBlock::PendingBlock(TracedRows rows, const BuiltJob& built, const std::vector<Evaluator*>& evaluators)
    : rows_(std::move(rows)), built_(&built), evaluators_(evaluators) {
  start();
}

void PendingBlock::start() {
  const Plan& plan = built_->plan();
  const std::size_t end = std::min(started_ + plan.queries_a_block, rows_.queries.size());
  parts_ = std::vector<Part>(plan.evaluators.size());
  std::vector<std::vector<Query>> queries(parts_.size());
  std::vector<std::uint8_t> asks(end - started_);
  tbb::parallel_for(std::size_t{0}, asks.size(), [&](std::size_t n) {
    asks[n] = built_->may_answer(rows_.queries[started_ + n]) ? 1 : 0;
  });
  for (const std::size_t first = started_; started_ < end; ++started_) {
    if (!asks[started_ - first]) {
      ++dropped_;
      continue;
    }
    const int evaluator = plan.evaluator_of_material[rows_.queries[started_].material];
    parts_[evaluator].places.push_back(started_);
    queries[evaluator].push_back(rows_.queries[started_].query);
  }
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    if (queries[n].empty()) continue;
    const auto material = static_cast<std::size_t>(plan.evaluators[n].first_material);
    const std::optional<GlintsDescription>& glints = built_->job().scene.materials[material].glints;
    if (glints)
      start_glints(&parts_[n], evaluators_[n], glints->colors, queries[n]);
    else
      parts_[n].pending = evaluators_[n]->start(queries[n]);
  }
}

void PendingBlock::start_glints(Part* part, Evaluator* evaluator, const std::vector<Color>& colors,
                                const std::vector<Query>& queries) {
  std::vector<GlintPoint> points;
  points.reserve(queries.size());
  for (const std::size_t place : part->places) points.push_back(rows_.queries[place].glints);
  part->pending = evaluator->start_at(queries, points);
  part->colors = colors;
}

/// The mean colour of a query's glints goes into its weight.
void PendingBlock::tint(const Part& part, const std::vector<float>& densities) {
  for (std::size_t n = 0; n < densities.size(); ++n) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t color = 0; color < part.colors.size(); ++color)
      sum += part.colors[color] * static_cast<double>(part.pending->density_of_color(color, n));
    Eigen::Vector3f& weight = rows_.queries[part.places[n]].weight;
    if (densities[n] > 0) weight = weight.cwiseProduct((sum / densities[n]).cast<float>());
  }
}

std::vector<float> PendingBlock::wait() {
  std::vector<float> densities(rows_.queries.size());
  for (;;) {
    for (Part& part : parts_) {
      if (!part.pending) continue;
      const std::vector<float> answers = part.pending->wait();
      for (std::size_t n = 0; n < answers.size(); ++n) densities[part.places[n]] = answers[n];
      if (!part.colors.empty()) tint(part, answers);
    }
    if (started_ == rows_.queries.size()) return densities;
    start();
  }
}

}  // namespace mica::host
