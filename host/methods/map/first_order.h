#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/methods/evaluator.h"

namespace mica::host {

using StartQueries = std::function<std::unique_ptr<PendingDensities>(const std::vector<Query>&)>;

/// Starts the queries whose half vector is constant and whose lobe is round by `plain`, with a scalar
/// roughness, and those with a first order by `first_order`: what a query does not have costs it nothing,
/// whatever else is in its batch.
std::unique_ptr<PendingDensities> start_by_order(const std::vector<Query>& queries, const StartQueries& plain,
                                                 const StartQueries& first_order);

/// For an evaluator that takes no first order: throws UsageError.
StartQueries refuse_first_order(const std::string& method);

}  // namespace mica::host
