#pragma once

#include <array>

#include "host/reference/cell_map.h"
#include "host/reference/query_frame.h"
#include "host/reference/triangle_rule.h"

namespace mica::host::reference {

/// The whitened corners of a block's cells, component by component so that loops over cells become vector
/// code.
struct CellBatch {
  static constexpr int capacity = CellMap::block_cells * CellMap::block_cells;

  int count = 0;
  double corners[4][4][capacity];    ///< [corner (0,0), (1,0), (0,1), (1,1)][component][cell]
  double nearest_squared[capacity];  ///< lower bound of |w|^2 on each cell

  /// Fills nearest_squared.
  void bound();
};

/// Triangles of a block, likewise.
struct TriangleBatch {
  static constexpr int capacity = 2 * CellBatch::capacity;

  int count = 0;
  double vertices[3][4][capacity];  ///< [vertex][component][triangle]
  int digits[capacity];             ///< accuracy needed: 10^-digits of each one's mean
  double gram[6][capacity];         ///< as in Gram
  int rule[capacity];               ///< index of the cheapest rule; the number of rules if none does

  /// Both triangles of a cell, split along the diagonal from (1, 0) to (0, 1).
  void push_cell(const CellBatch& cells, int cell, int needed_digits);
  /// Fills gram and rule.
  void choose_rules(const TriangleRules& rules);

  Gram gram_of(int triangle) const;
  std::array<Whitened, 3> vertices_of(int triangle) const;
};

/// The rule that choose_rules takes, for a single triangle.
int choose_rule(const TriangleRules& rules, const Gram& gram, int digits);
Gram gram_of(const std::array<Whitened, 3>& vertices);

}  // namespace mica::host::reference
