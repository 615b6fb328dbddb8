#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "host/methods/evaluator.h"

namespace mica::host {

/// Answers of several evaluators, put together in the order of the queries.
class CollectedDensities : public PendingDensities {
 public:
  explicit CollectedDensities(std::size_t count) : densities_(count) {}

  void add(std::unique_ptr<PendingDensities> pending, std::vector<std::size_t> places) {
    parts_.push_back({std::move(pending), std::move(places)});
  }
  std::vector<float> wait() override {
    for (Part& part : parts_) {
      const std::vector<float> answers = part.pending->wait();
      for (std::size_t n = 0; n < answers.size(); ++n) densities_[part.places[n]] = answers[n];
    }
    return std::move(densities_);
  }

 private:
  struct Part {
    std::unique_ptr<PendingDensities> pending;
    std::vector<std::size_t> places;
  };
  std::vector<Part> parts_;
  std::vector<float> densities_;
};

}  // namespace mica::host
