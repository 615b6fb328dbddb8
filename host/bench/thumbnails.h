#pragma once

#include <string>
#include <vector>

#include "host/bench/measure.h"
#include "host/bench/results.h"

namespace mica::bench {

/// One footprint's P-NDF as the oracle and as every contender sees it.
ThumbnailRow thumbnails(const std::string& name, const Surface& surface, const std::vector<int>& elements,
                        int side, Device& device, const Progress& progress);

}  // namespace mica::bench
