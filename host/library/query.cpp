#include "host/library/query.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "mica/error.h"

MICA_BEGIN_NAMESPACE
namespace {

template <typename T>
Queries rows_of(const T* rows, std::size_t count, int columns, double roughness) {
  if (columns != 7 && columns != 8 && columns != 14)
    throw UsageError(fmt::format("queries of {} columns; expected 7, 8 or 14", columns));
  if (rows == nullptr && count > 0) throw UsageError("queries: found no memory; expected rows");
  const auto column = [&](int n) { return Column(rows + n, columns); };
  Queries queries;
  queries.count = count;
  queries.u = column(0), queries.v = column(1);
  queries.cuu = column(2), queries.cuv = column(3), queries.cvv = column(4);
  queries.s = column(5), queries.t = column(6);
  queries.roughness = columns == 8 ? column(7) : Column(roughness);
  if (columns == 14) {
    queries.has_lobe = queries.has_turn = true;
    queries.rss = column(7), queries.rst = column(8), queries.rtt = column(9);
    queries.su = column(10), queries.sv = column(11), queries.tu = column(12), queries.tv = column(13);
  }
  return queries;
}

}  // namespace

Queries Queries::of_rows(const double* rows, std::size_t rows_count, int columns, double roughness) {
  return rows_of(rows, rows_count, columns, roughness);
}

Queries Queries::of_rows(const float* rows, std::size_t rows_count, int columns, double roughness) {
  return rows_of(rows, rows_count, columns, roughness);
}

Queries::Queries(Span<const Query> queries) {
  constexpr std::ptrdiff_t stride = sizeof(Query) / sizeof(double);
  static_assert(sizeof(Query) == 15 * sizeof(double), "a query is plain numbers");
  if (queries.data == nullptr && queries.size > 0)
    throw UsageError("queries: found no memory; expected a span");
  count = queries.size;
  if (count == 0) return;
  const Query& first = queries.data[0];
  const auto column = [&](const double& number) { return Column(&number, stride); };
  u = column(first.u), v = column(first.v);
  cuu = column(first.cuu), cuv = column(first.cuv), cvv = column(first.cvv);
  s = column(first.s), t = column(first.t), roughness = column(first.roughness);
  su = column(first.turn.su), sv = column(first.turn.sv), tu = column(first.turn.tu),
  tv = column(first.turn.tv);
  rss = column(first.lobe.rss), rst = column(first.lobe.rst), rtt = column(first.lobe.rtt);
  has_turn = has_lobe = true;
}

Query Queries::operator[](std::size_t n) const {
  Query query{u[n], v[n], cuu[n], cuv[n], cvv[n], s[n], t[n], roughness[n], {}, {}};
  if (has_turn) query.turn = {su[n], sv[n], tu[n], tv[n]};
  if (has_lobe) query.lobe = {rss[n], rst[n], rtt[n]};
  return query;
}

MICA_END_NAMESPACE

namespace mica::host {

Footprint to_footprint(const Footprints& f, std::size_t n) {
  Footprint footprint;
  footprint.mean_uv = {f.u[n], f.v[n]};
  footprint.cov_uv << f.cuu[n], f.cuv[n], f.cuv[n], f.cvv[n];
  return footprint;
}

Query to_query(const Queries& queries, std::size_t n) {
  return to_query(queries[n]);
}

Query to_query(const mica::Query& query) {
  Query result;
  result.footprint.mean_uv = {query.u, query.v};
  result.footprint.cov_uv << query.cuu, query.cuv, query.cuv, query.cvv;
  result.half_vector = {query.s, query.t};
  result.roughness = query.roughness;
  result.half_vector_turn << query.turn.su, query.turn.sv, query.turn.tu, query.turn.tv;
  const LobeCovariance& lobe = query.lobe;
  if (lobe.rss != 0 || lobe.rst != 0 || lobe.rtt != 0)
    result.lobe_cov = (Eigen::Matrix2d() << lobe.rss, lobe.rst, lobe.rst, lobe.rtt).finished();
  return result;
}

mica::Query to_public(const Query& query) {
  mica::Query result;
  result.u = query.footprint.mean_uv.x(), result.v = query.footprint.mean_uv.y();
  result.cuu = query.footprint.cov_uv(0, 0), result.cuv = query.footprint.cov_uv(0, 1);
  result.cvv = query.footprint.cov_uv(1, 1);
  result.s = query.half_vector.x(), result.t = query.half_vector.y();
  result.roughness = query.roughness;
  const Eigen::Matrix2d& turn = query.half_vector_turn;
  result.turn = {turn(0, 0), turn(0, 1), turn(1, 0), turn(1, 1)};
  if (query.lobe_cov)
    result.lobe = {(*query.lobe_cov)(0, 0), (*query.lobe_cov)(0, 1), (*query.lobe_cov)(1, 1)};
  return result;
}

namespace {

Eigen::Vector3d unit(double x, double y, double z, std::size_t number, const char* name) {
  const Eigen::Vector3d direction(x, y, z);
  if (!direction.allFinite() || direction.isZero(0))
    throw UsageError(fmt::format("query {}: {} = ({}, {}, {}); expected a finite direction of some length",
                                 number, name, x, y, z));
  return direction.stableNormalized();
}

}  // namespace

ViewQuery to_view(const Views& views, std::size_t n) {
  return {to_footprint(views, n), unit(views.ox[n], views.oy[n], views.oz[n], n, "o"), views.roughness[n]};
}

BrdfQuery to_lighting(const Lightings& queries, std::size_t n) {
  const ViewQuery view = to_view(queries, n);
  return {view.footprint, view.view, unit(queries.ix[n], queries.iy[n], queries.iz[n], n, "i"),
          view.roughness};
}

void check_columns(const Footprints& f) {
  if (f.count == 0) return;
  for (const Column* column : {&f.u, &f.v, &f.cuu, &f.cuv, &f.cvv})
    if (column->is_null()) throw UsageError("queries: found a column without memory; expected numbers");
}

void check_columns(const Queries& q) {
  check_columns(static_cast<const Footprints&>(q));
  if (q.count == 0) return;
  for (const Column* column : {&q.s, &q.t, &q.roughness, &q.su, &q.sv, &q.tu, &q.tv, &q.rss, &q.rst, &q.rtt})
    if (column->is_null()) throw UsageError("queries: found a column without memory; expected numbers");
}

}  // namespace mica::host
