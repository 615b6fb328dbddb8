#pragma once

#include <cstddef>
#include <vector>

namespace mica::host {

/// A rectangle of items whose rows and columns may begin below zero.
template <typename Item>
class Rectangle {
 public:
  Rectangle(int first_row, int rows, int first_column, int columns)
      : first_row_(first_row),
        first_column_(first_column),
        columns_(columns),
        items_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns)) {}
  Item& at(int row, int column) { return items_[place(row, column)]; }
  const Item& at(int row, int column) const { return items_[place(row, column)]; }

 private:
  std::size_t place(int row, int column) const {
    return static_cast<std::size_t>(row - first_row_) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column - first_column_);
  }
  int first_row_, first_column_, columns_;
  std::vector<Item> items_;
};

}  // namespace mica::host
