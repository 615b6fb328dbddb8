#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/scene/scene.h"

namespace mica::host {

/// Which samples lie in a block's own rows, and which in the margins around them, whose samples its pixels
/// see, too. Those of its own go from the first of its rows to the one after the last; kNone are pixels' own.
class OwnSamples {
 public:
  explicit OwnSamples(const TracedRows& rows) {
    const Lattice& lattice = rows.lattice;
    const auto first_of = [&](int row) {
      for (std::size_t cell = lattice.cell(row, -lattice.margin); cell < lattice.first_sample.size(); ++cell)
        if (lattice.first_sample[cell] != Lattice::kNone) return lattice.first_sample[cell];
      return Lattice::kNone;
    };
    first_ = first_of(0), end_ = first_of(rows.row_count);
  }

  bool has(std::uint32_t sample) const {
    return sample == Lattice::kNone || (sample >= first_ && sample < end_);
  }

 private:
  std::uint32_t first_ = 0, end_ = 0;
};

}  // namespace mica::host
