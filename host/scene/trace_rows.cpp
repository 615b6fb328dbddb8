#include "host/scene/trace_rows.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/base/random.h"
#include "host/scene/footprint.h"
#include "host/scene/pixel_fit.h"
#include "host/scene/wrap.h"

namespace mica::host {
namespace {

/// Where on a light the shadow ray of a subpixel ends: all subpixels of a pixel cover the light evenly, in an
/// order of the pixel's own, so that penumbras have no bands.
Eigen::Vector2d shadow_sample(std::uint64_t pixel, int subpixel, int subpixels) {
  const std::uint64_t hash = scramble_bits((pixel + 1) * kGoldenBits);
  const double step = 1.0 / subpixels, unit = 1.0 / 4294967296.0;
  const Eigen::Vector2d shift(unit * static_cast<double>(hash >> 32),
                              unit * static_cast<double>(hash & 0xffffffffu));
  return wrap(step * Eigen::Vector2d(subpixel % subpixels, subpixel / subpixels) + shift);
}

/// Sums of one pixel's AOVs over the samples that hit a shape.
class PixelMeans {
 public:
  void add(const Footprint& footprint, const Eigen::Vector3d& normal) {
    if (count_ == 0) first_uv_ = footprint.mean_uv;
    const Eigen::Vector2d step = footprint.mean_uv - first_uv_;
    uv_offset_ += step - step.array().round().matrix();  // the short way across the wrap
    covariance_ += Eigen::Vector3d(footprint.cov_uv(0, 0), footprint.cov_uv(0, 1), footprint.cov_uv(1, 1));
    normal_ += normal;
    ++count_;
  }
  void write(TracedRows* rows, std::size_t pixel) const {
    if (count_ == 0) return;
    const Eigen::Vector2f uv = wrap(first_uv_ + uv_offset_ / count_).cast<float>();
    rows->uv[pixel] = (uv.array() < 1).select(uv, 0);
    rows->footprint[pixel] = (covariance_ / count_).cast<float>();
    rows->normal[pixel] = (normal_ / count_).cast<float>();
  }

 private:
  int count_ = 0;
  Eigen::Vector2d first_uv_{0, 0}, uv_offset_{0, 0};
  Eigen::Vector3d covariance_{0, 0, 0}, normal_{0, 0, 0};
};

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
  return rows;
}

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

/// What a fitted pixel shows; unset: it needs samples.
struct FittedPixel {
  Color radiance = Color::Zero();
  std::optional<Footprint> footprint;  ///< of a shape
  Eigen::Vector3d normal{0, 0, 0};
  std::vector<GlintQuery> queries;
};

/// All steps of a block of rows. Rows and columns count from the block's first pixel.
class BlockTracer {
 public:
  BlockTracer(const Viewer& viewer, const PixelSettings& pixels, const ImagePart& part)
      : viewer_(viewer),
        pixels_(pixels),
        image_width_(part.image_width),
        width_(part.column_count),
        first_row_(part.first_row),
        first_column_(part.first_column),
        first_seen_(std::max(-margin_, -first_row_)),
        end_seen_(std::min(part.row_count + margin_, part.image_height - first_row_)),
        rows_(empty_rows(first_row_, part.row_count, width_)),
        fits_(first_seen_, std::max(end_seen_ - first_seen_, 0), 0, width_) {
    rows_.lattice = {width_, margin_, pixels.subpixels, lattice_filter_, {}};
  }

  TracedRows trace() {
    if (rows_.row_count == 0) return std::move(rows_);
    if (pixels_.fits) fit_pixels();
    place_samples();
    const int places = rows_.row_count + 2 * margin_;
    std::vector<RowQueries> queries(static_cast<std::size_t>(places));
    tbb::parallel_for(-margin_, rows_.row_count + margin_, [&](int row) {
      const int place = row + margin_;
      RowQueries* here = &queries[static_cast<std::size_t>(place)];
      if (row >= 0 && row < rows_.row_count) write_fits(row, here);
      sample_row(row, here);
    });
    join(&queries, &RowQueries::glints, &rows_.queries);
    join(&queries, &RowQueries::points, &rows_.points);
    join(&queries, &RowQueries::lit, &rows_.lit);
    return std::move(rows_);
  }

 private:
  using Fits = Rectangle<std::optional<FittedPixel>>;

  /// A number for a place of the image; inside it that of the pixel.
  std::uint64_t key(int row, int column) const {
    const std::int64_t down = first_row_ + row, right = first_column_ + column;
    if (down >= 0 && right >= 0 && right < image_width_)
      return static_cast<std::uint64_t>(down) * static_cast<std::uint64_t>(image_width_) +
             static_cast<std::uint64_t>(right);
    return scramble_bits(static_cast<std::uint64_t>(down) * kGoldenBits + static_cast<std::uint64_t>(right));
  }
  Probe probe(double row, double column, std::uint64_t corner) const {
    const std::uint64_t hash = random_bits(
        key(static_cast<int>(std::floor(row)), static_cast<int>(std::floor(column))), kProbes, corner);
    return probe_of(viewer_.look(first_column_ + column, first_row_ + row, shadow_sample(hash, 0, 1)));
  }

  void fit_pixels();
  std::optional<FittedPixel> fit(int row, int column) const;
  bool agree(int row, int column) const;
  void place_samples();
  void write_fits(int row, RowQueries* queries);
  void sample_row(int row, RowQueries* queries);
  void sample_cell(int row, int column, std::uint32_t first_sample, RowQueries* queries);
  std::vector<std::vector<Eigen::Matrix2d>> turns_of(const std::vector<SeenPoint>& points) const;
  bool has_fit(int row, int column) const {
    return row >= first_seen_ && row < end_seen_ && column >= 0 && column < width_ &&
           fits_.at(row, column).has_value();
  }
  /// Whether a sample has weight in a pixel, of a part that is one: by subpixels from its first ones.
  bool is_seen(int down, int right) const {
    if (width_ != 1 || rows_.row_count != 1) return true;
    const auto counts = [&](int subpixel) {
      return lattice_filter_.weights[static_cast<std::size_t>(subpixel)] > 0;
    };
    const int first = margin_ * pixels_.subpixels;
    return counts(down + first) && counts(right + first);
  }
  bool is_sampled(int row, int column) const {
    return row >= first_seen_ && row < end_seen_ && column >= 0 && column < width_ && !has_fit(row, column);
  }

  static constexpr std::uint64_t kProbes = 0x70726f6265;  // a stream of its own
  const Viewer& viewer_;
  const PixelSettings& pixels_;
  const int image_width_, width_, first_row_, first_column_;
  const FilterSum lattice_filter_ = pixels_.filter.on_lattice(pixels_.subpixels);
  const FilterSum few_ = pixels_.filter.by_few();
  const int margin_ = pixels_.filter.margin_pixels(), reach_ = std::max(margin_, 1);
  const int first_seen_, end_seen_;  // pixels of the image that the block has to know of
  TracedRows rows_;
  Fits fits_;
  std::optional<Rectangle<Probe>> centers_, corners_;
};

/// Two rays a pixel: at its centre and at a corner, which four pixels share.
void BlockTracer::fit_pixels() {
  const int first = first_seen_ - reach_, end = end_seen_ + reach_;
  centers_.emplace(first, end - first, -reach_, width_ + 2 * reach_);
  corners_.emplace(first, end + 1 - first, -reach_, width_ + 2 * reach_ + 1);
  tbb::parallel_for(first, end + 1, [&](int row) {
    for (int column = -reach_; column <= width_ + reach_; ++column) {
      corners_->at(row, column) = probe(row, column, 1);
      if (row < end && column < width_ + reach_)
        centers_->at(row, column) = probe(row + 0.5, column + 0.5, 0);
    }
  });
  tbb::parallel_for(first_seen_, end_seen_, [&](int row) {
    for (int column = 0; column < width_; ++column) fits_.at(row, column) = fit(row, column);
  });
  centers_.reset(), corners_.reset();
}

/// Whether all rays within the filter's reach meet one surface, and each lamp shines on all or none of them.
bool BlockTracer::agree(int row, int column) const {
  const Probe& middle = centers_->at(row, column);
  const auto is_alike = [&](const Probe& probe) {
    if (probe.surface != middle.surface || probe.faces_eye != middle.faces_eye) return false;
    for (std::size_t n = 0; n < probe.lamps.size(); ++n)
      if (probe.lamps[n].shines != middle.lamps[n].shines) return false;
    return true;
  };
  for (int down = -reach_; down <= reach_ + 1; ++down)
    for (int right = -reach_; right <= reach_ + 1; ++right) {
      if (!is_alike(corners_->at(row + down, column + right))) return false;
      if (down <= reach_ && right <= reach_ && !is_alike(centers_->at(row + down, column + right)))
        return false;
    }
  return true;
}

std::optional<FittedPixel> BlockTracer::fit(int row, int column) const {
  const Probe& middle = centers_->at(row, column);
  const bool hit = middle.surface != Probe::kNothing;
  if (hit && (!middle.faces_eye || !pixels_.takes_first_order[middle.material])) return std::nullopt;
  if (!agree(row, column)) return std::nullopt;
  std::array<const Probe*, PixelFit::kRays> probes;
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const Eigen::Vector2d& offset = PixelFit::offsets()[n];
    const bool corner = offset.x() != std::round(offset.x());
    probes[n] =
        corner ? &corners_->at(row + (offset.y() > 0 ? 1 : 0), column + (offset.x() > 0 ? 1 : 0))
               : &centers_->at(row + static_cast<int>(offset.y()), column + static_cast<int>(offset.x()));
  }
  const PixelFit fitted(probes);
  FittedPixel pixel;
  pixel.radiance = fitted.radiance(few_);
  if (!hit) return pixel;
  pixel.footprint = fitted.footprint(few_);
  pixel.normal = middle.normal;
  const FitLimits limits{pixels_.largest_residual, std::max(1, pixels_.subpixels * pixels_.subpixels)};
  for (std::size_t lamp = 0; lamp < middle.lamps.size(); ++lamp)
    if (middle.lamps[lamp].shines &&
        !fitted.ask(lamp, few_, pixels_.normal_change[middle.material], limits, &pixel.queries))
      return std::nullopt;
  for (GlintQuery& query : pixel.queries) query.material = middle.material;
  return pixel;
}

/// Pixels without a fit need the samples of all pixels that their filter reaches.
void BlockTracer::place_samples() {
  Lattice& lattice = rows_.lattice;
  lattice.first_sample.assign(lattice.cell(rows_.row_count + margin_, -margin_), Lattice::kNone);
  std::uint32_t count = 0;
  for (int row = -margin_; row < rows_.row_count + margin_; ++row)
    for (int column = -margin_; column < width_ + margin_; ++column) {
      bool needed = false;
      for (int down = -margin_; down <= margin_ && !needed; ++down)
        for (int right = -margin_; right <= margin_ && !needed; ++right) {
          const bool of_block = row >= 0 && row < rows_.row_count;
          // What lies outside of the block is there for the block alone.
          const int other = row + down;
          needed = (of_block || (other >= 0 && other < rows_.row_count)) && is_sampled(other, column + right);
        }
      if (!needed) continue;
      lattice.first_sample[lattice.cell(row, column)] = count;
      count += static_cast<std::uint32_t>(pixels_.subpixels * pixels_.subpixels);
    }
  rows_.sample_radiance.assign(count, Eigen::Vector3f::Zero());
}

void BlockTracer::write_fits(int row, RowQueries* queries) {
  for (int column = 0; column < width_; ++column) {
    std::optional<FittedPixel>& fitted = fits_.at(row, column);
    if (!fitted) continue;
    const std::size_t pixel =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
    rows_.fitted[pixel] = 1;
    rows_.radiance[pixel] = fitted->radiance.cast<float>();
    PixelMeans means;
    if (fitted->footprint) means.add(*fitted->footprint, fitted->normal);
    means.write(&rows_, pixel);
    for (GlintQuery& query : fitted->queries) {
      query.pixel = static_cast<std::uint32_t>(pixel);
      if (query.weight.maxCoeff() > 0) queries->glints.push_back(query);
    }
    rows_.query_count[pixel] = static_cast<std::uint16_t>(fitted->queries.size());
  }
}

void BlockTracer::sample_row(int row, RowQueries* queries) {
  for (int column = -margin_; column < width_ + margin_; ++column) {
    const std::uint32_t first = rows_.lattice.first_sample[rows_.lattice.cell(row, column)];
    if (first != Lattice::kNone) sample_cell(row, column, first, queries);
  }
}

void BlockTracer::sample_cell(int row, int column, std::uint32_t first_sample, RowQueries* queries) {
  const int n = pixels_.subpixels;
  std::vector<SeenPoint> points;
  for (int k = 0; k < n * n; ++k) {
    const int right = k % n, down = k / n;
    if (!is_seen(row * n + down, column * n + right)) {
      points.emplace_back();
      continue;
    }
    points.push_back(viewer_.look(first_column_ + column + (right + 0.5) / n,
                                  first_row_ + row + (down + 0.5) / n,
                                  shadow_sample(key(row, column), k, n)));
  }
  const std::vector<std::vector<Eigen::Matrix2d>> turns = turns_of(points);
  const bool owned = row >= 0 && row < rows_.row_count && column >= 0 && column < width_;
  const auto pixel = owned ? static_cast<std::uint32_t>(row * width_ + column) : GlintQuery::kNone;
  const std::size_t before = queries->size();
  PixelMeans means;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SeenPoint& point = points[k];
    const auto sample = first_sample + static_cast<std::uint32_t>(k);
    rows_.sample_radiance[sample] = point.radiance.cast<float>();
    if (!point.hit) continue;
    means.add({wrap(point.uv), footprint_covariance(point.duv, lattice_filter_.sigma_pixels)}, point.frame.z);
    if (point.faces_eye)
      viewer_.ask(point, lattice_filter_.sigma_pixels,
                  {pixel, sample, key(row, column), static_cast<std::uint32_t>(k)}, turns[k], queries);
  }
  if (!owned || has_fit(row, column)) return;
  means.write(&rows_, pixel);
  rows_.query_count[pixel] =
      static_cast<std::uint16_t>(std::min<std::size_t>(queries->size() - before, 65535));
}

/// A lamp's half vector's change a pixel to the right and down, at point k of a pixel of n x n: by
/// differences to its neighbours in the pixel that lie on the same surface in the lamp's light. None where it
/// has none along one of both axes.
std::optional<Eigen::Matrix2d> half_vector_change(const std::vector<SeenPoint>& points, int n, int k,
                                                  std::size_t lamp) {
  const SeenPoint& middle = points[static_cast<std::size_t>(k)];
  const auto is_alike = [&](const SeenPoint& point) {
    return point.hit && point.faces_eye && point.hit->shape == middle.hit->shape &&
           point.hit->part == middle.hit->part && point.lamps[lamp].shines;
  };
  const int place[2] = {k % n, k / n}, stride[2] = {1, n};
  Eigen::Matrix2d change;
  for (int axis = 0; axis < 2; ++axis) {
    int ends[2] = {0, 0};  // steps to the neighbours
    for (const int step : {-1, 1}) {
      const int to = place[axis] + step, index = k + step * stride[axis];
      if (to >= 0 && to < n && is_alike(points[static_cast<std::size_t>(index)])) ends[step > 0] = step;
    }
    if (ends[0] == ends[1]) return std::nullopt;
    const auto half_vector = [&](int step) -> const Eigen::Vector2d& {
      const int index = k + step * stride[axis];
      return points[static_cast<std::size_t>(index)].lamps[lamp].half_vector;
    };
    change.col(axis) = (half_vector(ends[1]) - half_vector(ends[0])) * n / (ends[1] - ends[0]);
  }
  return change;
}

/// The half vectors' turns over the samples of a pixel, by sample and lamp.
std::vector<std::vector<Eigen::Matrix2d>> BlockTracer::turns_of(const std::vector<SeenPoint>& points) const {
  std::vector<std::vector<Eigen::Matrix2d>> turns(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SeenPoint& point = points[k];
    if (!point.hit || !point.faces_eye || !pixels_.takes_first_order[point.material]) continue;
    turns[k].assign(point.lamps.size(), Eigen::Matrix2d::Zero());
    for (std::size_t lamp = 0; lamp < point.lamps.size(); ++lamp) {
      if (!point.lamps[lamp].shines) continue;
      const auto change = half_vector_change(points, pixels_.subpixels, static_cast<int>(k), lamp);
      const double least = kLeastTurn * point.lamps[lamp].seen.roughness / lattice_filter_.sigma_pixels;
      if (change && change->norm() > least) turns[k][lamp] = turn_over(point.duv, *change);
    }
  }
  return turns;
}

}  // namespace

TracedRows trace_rows(const Viewer& viewer, const PixelSettings& pixels, const ImagePart& part) {
  return BlockTracer(viewer, pixels, part).trace();
}

}  // namespace mica::host
