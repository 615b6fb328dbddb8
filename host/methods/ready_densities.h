#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "host/methods/evaluator.h"

namespace mica::host {

/// Densities that the host has already computed.
class ReadyDensities : public PendingDensities {
 public:
  explicit ReadyDensities(std::vector<float> densities) : densities_(std::move(densities)) {}
  std::vector<float> wait() override { return std::move(densities_); }

 private:
  std::vector<float> densities_;
};

}  // namespace mica::host
