#pragma once

#include "host/base/query.h"
#include "mica/query.h"

namespace mica::host {

/// Query n of the caller's memory.
Query to_query(const Queries& queries, std::size_t n);
Query to_query(const mica::Query& query);
mica::Query to_public(const Query& query);

Footprint to_footprint(const Footprints& footprints, std::size_t n);
ViewQuery to_view(const Views& views, std::size_t n);
BrdfQuery to_lighting(const Lightings& queries, std::size_t n);

/// Throws UsageError for columns without memory.
void check_columns(const Queries& queries);
void check_columns(const Footprints& footprints);

}  // namespace mica::host
