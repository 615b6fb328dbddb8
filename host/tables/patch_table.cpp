#include "host/tables/patch_table.h"

#include <fmt/format.h>

#include "host/base/random.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr std::size_t kView = 5, kLight = 8;  // columns

std::vector<std::string> columns_of(PatchQuantity quantity) {
  std::vector<std::string> names = {"u", "v", "cuu", "cuv", "cvv", "ox", "oy", "oz"};
  if (quantity == PatchQuantity::brdf) names.insert(names.end(), {"ix", "iy", "iz"});
  names.push_back("roughness");
  return names;
}

std::string direction_problem(const char* name, const Eigen::Vector3d& direction) {
  if (!direction.allFinite()) return fmt::format("direction {} is not finite", name);
  if (direction.isZero(0)) return fmt::format("direction {} has length 0", name);
  return {};
}

}  // namespace

PatchTable::PatchTable(const std::string& path, PatchQuantity quantity, std::optional<double> roughness)
    : path_(path),
      quantity_(quantity),
      columns_(columns_of(quantity).size() - 1),
      table_(open_query_table(path, columns_of(quantity))) {
  if (table_.source().columns() > columns_) return;
  if (!roughness)
    throw UsageError(fmt::format("{}: has no column roughness, so --roughness is needed", path));
  roughness_ = *roughness;
}

Eigen::Vector3d PatchTable::direction(std::size_t row, std::size_t column) const {
  return {table_.at(row, column), table_.at(row, column + 1), table_.at(row, column + 2)};
}

ViewQuery PatchTable::view(std::size_t row) const {
  ViewQuery query;
  query.footprint.mean_uv = {table_.at(row, 0), table_.at(row, 1)};
  query.footprint.cov_uv << table_.at(row, 2), table_.at(row, 3), table_.at(row, 3), table_.at(row, 4);
  query.view = direction(row, kView).stableNormalized();
  query.roughness = table_.source().columns() > columns_ ? table_.at(row, columns_) : roughness_;
  return query;
}

BrdfQuery PatchTable::brdf(std::size_t row) const {
  const ViewQuery from = view(row);
  return {from.footprint, from.view, direction(row, kLight).stableNormalized(), from.roughness};
}

SampleQuery PatchTable::sample(std::size_t row, std::uint64_t seed) const {
  return {view(row), random_bits(seed, 0, row)};
}

void PatchTable::check(const TableRange& rows,
                       const std::function<std::string(const ViewQuery&)>& view_problem) const {
  check_rows(path_, rows, [&](std::size_t row) {
    std::string text = direction_problem("o", direction(row, kView));
    if (text.empty() && quantity_ == PatchQuantity::brdf)
      text = direction_problem("i", direction(row, kLight));
    return text.empty() ? view_problem(view(row)) : text;
  });
}

}  // namespace mica::host
