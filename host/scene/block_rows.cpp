#include "host/scene/block_rows.h"

#include "host/scene/wrap.h"

namespace mica::host {
namespace {

template <typename Item>
void join(std::vector<RowQueries>* rows, std::vector<Item> RowQueries::*part, std::vector<Item>* all) {
  std::size_t total = 0;
  for (const RowQueries& row : *rows) total += (row.*part).size();
  all->reserve(total);
  for (RowQueries& row : *rows) {
    all->insert(all->end(), (row.*part).begin(), (row.*part).end());
    std::vector<Item>().swap(row.*part);
  }
}

}  // namespace

void PixelMeans::add(const Footprint& footprint, const Eigen::Vector3d& normal) {
  if (count_ == 0) first_uv_ = footprint.mean_uv;
  const Eigen::Vector2d step = footprint.mean_uv - first_uv_;
  uv_offset_ += step - step.array().round().matrix();  // the short way across the wrap
  covariance_ += Eigen::Vector3d(footprint.cov_uv(0, 0), footprint.cov_uv(0, 1), footprint.cov_uv(1, 1));
  normal_ += normal;
  ++count_;
}

void PixelMeans::write(TracedRows* rows, std::size_t pixel) const {
  if (count_ == 0) return;
  const Eigen::Vector2f uv = wrap(first_uv_ + uv_offset_ / count_).cast<float>();
  rows->uv[pixel] = (uv.array() < 1).select(uv, 0);
  rows->footprint[pixel] = (covariance_ / count_).cast<float>();
  rows->normal[pixel] = (normal_ / count_).cast<float>();
}

TracedRows empty_rows(int first_row, int row_count, int width) {
  TracedRows rows;
  rows.first_row = first_row, rows.row_count = row_count;
  const std::size_t pixels = static_cast<std::size_t>(row_count) * static_cast<std::size_t>(width);
  rows.fitted.assign(pixels, 0);
  rows.radiance.assign(pixels, Eigen::Vector3f::Zero());
  rows.uv.assign(pixels, Eigen::Vector2f::Zero());
  rows.footprint.assign(pixels, Eigen::Vector3f::Zero());
  rows.normal.assign(pixels, Eigen::Vector3f::Zero());
  rows.query_count.assign(pixels, 0);
  rows.doubt.assign(pixels, 0);
  rows.sampled_lamps.resize(pixels);
  return rows;
}

void join_queries(std::vector<RowQueries>* rows, TracedRows* all) {
  join(rows, &RowQueries::glints, &all->queries);
  join(rows, &RowQueries::points, &all->points);
  join(rows, &RowQueries::lit, &all->lit);
  join(rows, &RowQueries::lamp_samples, &all->lamp_samples);
}

}  // namespace mica::host
