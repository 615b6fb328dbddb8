#pragma once

#include <memory>
#include <vector>

#include "host/methods/evaluator.h"
#include "host/render/built_job.h"
#include "host/scene/scene.h"

namespace mica::host {

/// The densities of a block of traced rows, on their way from all evaluators.
class PendingBlock {
 public:
  PendingBlock(TracedRows rows, const BuiltJob& built);
  /// @param evaluators by PlannedEvaluator, to be asked in place of the job's own.
  PendingBlock(TracedRows rows, const BuiltJob& built, const std::vector<Evaluator*>& evaluators);

  /// Once waited for, the weights of glints are tinted by their colours.
  const TracedRows& rows() const { return rows_; }
  TracedRows& rows() { return rows_; }
  /// D of every query, in the order of rows().queries. Call once.
  std::vector<float> wait();
  /// Of its queries, how many were not asked, since no normal could answer: their D is 0.
  std::size_t dropped() const { return dropped_; }

 private:
  /// Those of its queries that are on the device, by evaluator.
  struct Part {
    std::vector<std::size_t> places;
    std::unique_ptr<PendingDensities> pending;
    std::vector<Eigen::Vector3d> colors;  ///< that glints have
  };
  void start();
  void start_glints(Part* part, Evaluator* evaluator, const std::vector<Color>& colors,
                    const std::vector<Query>& queries);
  void tint(const Part& part, const std::vector<float>& densities);

  TracedRows rows_;
  const BuiltJob* built_;
  std::vector<Evaluator*> evaluators_;
  std::vector<Part> parts_;  // by evaluator
  std::size_t started_ = 0;  // of the rows' queries; no more at a time than the plan has room for
  std::size_t dropped_ = 0;
};

}  // namespace mica::host
