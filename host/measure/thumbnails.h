#pragma once

#include <string>
#include <vector>

#include "host/measure/measure.h"
#include "host/measure/results.h"

namespace mica::host::bench {

/// One footprint's P-NDF as the oracle and as every contender sees it.
ThumbnailRow thumbnails(const std::string& name, const Surface& surface,
                        const std::vector<Prepared>& contenders, int side, const Progress& progress);

}  // namespace mica::host::bench
