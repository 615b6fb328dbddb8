#pragma once

#include <vector>

#include "python/src/bindings.h"

namespace mica::python {

using ColumnDict = nb::typed<nb::dict, nb::str, nb::any>;

/// Queries as the Python side hands them over: each column's name with a number, or with an array of one
/// dimension that is read in place. It keeps these arrays; the GIL has to be held where it ends.
class Columns {
 public:
  Columns(std::size_t count, nb::dict columns) : count_(count), columns_(std::move(columns)) {}

  Queries queries();
  Views views();
  Lightings lightings();
  Footprints footprints();
  Column roughness();

 private:
  bool has(const char* name) const { return columns_.contains(name); }
  /// Throws UsageError for an array of another length.
  Column column(const char* name);
  void set_footprints(Footprints* footprints);
  void set_views(Views* views);

  std::size_t count_;
  nb::dict columns_;
  std::vector<Array> arrays_;
};

}  // namespace mica::python
