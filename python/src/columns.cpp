#include "python/src/columns.h"

namespace mica::python {

Column Columns::column(const char* name) {
  const nb::object value = columns_[name];
  if (nb::isinstance<nb::float_>(value)) return Column(nb::cast<double>(value));
  const Array& array = arrays_.emplace_back(nb::cast<Array>(value));
  if (array.ndim() != 1 || array.shape(0) != count_)
    throw UsageError(std::string(name) + ": expected one number a query");
  if (array.dtype() == nb::dtype<float>())
    return Column(static_cast<const float*>(array.data()), array.stride(0));
  if (array.dtype() == nb::dtype<double>())
    return Column(static_cast<const double*>(array.data()), array.stride(0));
  throw UsageError(std::string(name) + ": expected float32 or float64");
}

Column Columns::roughness() {
  return column("roughness");
}

void Columns::set_footprints(Footprints* footprints) {
  footprints->count = count_;
  footprints->u = column("u"), footprints->v = column("v");
  footprints->cuu = column("cuu"), footprints->cuv = column("cuv"), footprints->cvv = column("cvv");
}

void Columns::set_views(Views* views) {
  set_footprints(views);
  views->ox = column("ox"), views->oy = column("oy"), views->oz = column("oz");
  views->roughness = roughness();
}

Footprints Columns::footprints() {
  Footprints footprints;
  set_footprints(&footprints);
  return footprints;
}

Queries Columns::queries() {
  Queries queries;
  set_footprints(&queries);
  queries.s = column("s"), queries.t = column("t");
  if (has("roughness")) queries.roughness = roughness();
  if (has("rss")) {
    queries.has_lobe = true;
    queries.rss = column("rss"), queries.rst = column("rst"), queries.rtt = column("rtt");
  }
  if (has("su")) {
    queries.has_turn = true;
    queries.su = column("su"), queries.sv = column("sv"), queries.tu = column("tu"),
    queries.tv = column("tv");
  }
  return queries;
}

Views Columns::views() {
  Views views;
  set_views(&views);
  return views;
}

Lightings Columns::lightings() {
  Lightings lightings;
  set_views(&lightings);
  lightings.ix = column("ix"), lightings.iy = column("iy"), lightings.iz = column("iz");
  return lightings;
}

}  // namespace mica::python
