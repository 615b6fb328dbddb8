#include "host/surface/features.h"

namespace mica::host::synthesis {

void RowBands::add(std::uint32_t feature, const TexelRange& rows) {
  for (long row = rows.first; row <= rows.last; ++row) {
    std::vector<std::uint32_t>& band = features_[wrapped(row, resolution_) / kRows];
    if (band.empty() || band.back() != feature) band.push_back(feature);
  }
}

}  // namespace mica::host::synthesis
