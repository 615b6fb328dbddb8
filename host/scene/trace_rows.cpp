#include "host/scene/trace_rows.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/scene/block_rows.h"
#include "host/scene/footprint.h"
#include "host/scene/light_samples.h"
#include "host/scene/pixel_probes.h"
#include "host/scene/sample_turns.h"
#include "host/scene/wrap.h"

namespace mica::host {
namespace {

/// Of the share of a lamp that is seen, between a fit and its rays, root mean square: 36 shadow rays are off
/// by 0.06 where half of it is seen; an edge of a shadow less than 0.4 pixels from the centre is by 0.14 to
/// 0.23.
constexpr double kMostPenumbraResidual = 0.12;

/// Of the lamps that a pixel sees, those that samples may stand for, each for itself, while a fit does for
/// the others. Where there are more of them all of the pixel is sampled, and refined where it is in doubt.
constexpr double kMostSampledLamps = 0.25;

/// What a fitted pixel shows; unset: it needs samples.
struct FittedPixel {
  Color radiance = Color::Zero();
  std::optional<Footprint> footprint;  ///< of a shape
  Eigen::Vector3d normal{0, 0, 0};
  std::vector<GlintQuery> queries;
  std::vector<std::uint32_t> sampled_lamps;  ///< that need samples, in order
};

/// The lamps that samples are taken of.
struct WantedLamps {
  bool all = false;
  std::vector<std::uint32_t> some;  ///< in order
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
    return take_samples();
  }

  /// @param chosen by cell of the lattice.
  TracedRows sample(const Lattice::Choice& chosen) {
    chosen_ = &chosen;
    return take_samples();
  }

 private:
  TracedRows take_samples() {
    place_samples();
    const int places = rows_.row_count + 2 * margin_;
    std::vector<RowQueries> queries(static_cast<std::size_t>(places));
    tbb::parallel_for(-margin_, rows_.row_count + margin_, [&](int row) {
      const int place = row + margin_;
      RowQueries* here = &queries[static_cast<std::size_t>(place)];
      if (row >= 0 && row < rows_.row_count) write_fits(row, here);
      sample_row(row, here);
    });
    join_queries(&queries, &rows_);
    return std::move(rows_);
  }

  using Fits = Rectangle<std::optional<FittedPixel>>;

  /// A number for a place of the image; inside it that of the pixel.
  std::uint64_t key(int row, int column) const {
    return place_key(first_row_ + row, first_column_ + column, image_width_);
  }

  void fit_pixels();
  std::optional<FittedPixel> fit(int row, int column) const;
  void place_samples();
  void write_fits(int row, RowQueries* queries);
  void sample_row(int row, RowQueries* queries);
  WantedLamps wanted_lamps(int row, int column) const;
  void sample_cell(int row, int column, std::uint32_t first_sample, RowQueries* queries);
  void own_lamps(int row, int column, std::size_t first_glint, RowQueries* queries);
  std::vector<SeenPoint> look(const Viewer& viewer, int row, int column) const;
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
  bool is_chosen(int row, int column, int k) const {
    return !chosen_ || (*chosen_)[rows_.lattice.cell(row, column)][static_cast<std::size_t>(k)];
  }
  /// Whether a sample or one next to it in its pixel is: half vectors turn from one to the next.
  bool is_near_chosen(int row, int column, int k) const {
    const int n = pixels_.subpixels, right = k % n, down = k / n;
    return is_chosen(row, column, k) || (right > 0 && is_chosen(row, column, k - 1)) ||
           (right + 1 < n && is_chosen(row, column, k + 1)) || (down > 0 && is_chosen(row, column, k - n)) ||
           (down + 1 < n && is_chosen(row, column, k + n));
  }
  /// Of one of the block's rows.
  std::size_t pixel_of(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  }
  bool is_of_block(int row, int column) const {
    return row >= 0 && row < rows_.row_count && column >= 0 && column < width_;
  }
  std::vector<LightDescription> lights_of(const std::vector<std::uint32_t>& lamps) const {
    std::vector<LightDescription> lights;
    for (const std::uint32_t lamp : lamps) lights.push_back(viewer_.lights[lamp]);
    return lights;
  }
  bool is_sampled(int row, int column) const {
    return row >= first_seen_ && row < end_seen_ && column >= 0 && column < width_ && !has_fit(row, column);
  }
  bool samples_lamps(int row, int column) const {
    return has_fit(row, column) && !fits_.at(row, column)->sampled_lamps.empty();
  }
  /// Calls visit(row, column) for pixels that see what lies in one, and says whether any returned true. What
  /// lies outside of the block is there for the block alone.
  template <typename Visit>
  bool any_around(int row, int column, const Visit& visit) const {
    const bool of_block = row >= 0 && row < rows_.row_count;
    for (int other = row - margin_; other <= row + margin_; ++other) {
      if (!of_block && (other < 0 || other >= rows_.row_count)) continue;
      for (int right = -margin_; right <= margin_; ++right)
        if (visit(other, column + right)) return true;
    }
    return false;
  }

  const Viewer& viewer_;
  const PixelSettings& pixels_;
  const int image_width_, width_, first_row_, first_column_;
  const FilterSum lattice_filter_ = pixels_.filter.on_lattice(pixels_.subpixels);
  const FilterSum few_ = pixels_.filter.by_few();
  const int margin_ = pixels_.filter.margin_pixels(), reach_ = std::max(margin_, 1);
  const Lattice::Choice* chosen_ = nullptr;  // the only samples that are taken
  const int first_seen_, end_seen_;          // pixels of the image that the block has to know of
  TracedRows rows_;
  Fits fits_;
  std::optional<PixelProbes> probes_;
};

void BlockTracer::fit_pixels() {
  probes_.emplace(viewer_,
                  ProbedPixels{first_seen_, end_seen_, 0, width_, first_row_, first_column_, image_width_},
                  reach_, pixels_.lamp_parts);
  tbb::parallel_for(first_seen_, end_seen_, [&](int row) {
    for (int column = 0; column < width_; ++column) fits_.at(row, column) = fit(row, column);
  });
  probes_.reset();
}

std::optional<FittedPixel> BlockTracer::fit(int row, int column) const {
  const Probe& middle = probes_->center(row, column);
  const bool hit = middle.surface != Probe::kNothing;
  if (hit && (!middle.faces_eye || !pixels_.takes_first_order[middle.material])) return std::nullopt;
  if (!probes_->agree(row, column)) return std::nullopt;
  const FitStencil& stencil = FitStencil::centers_and_corners();
  const ProbesOfFit probes = probes_->of_fit(row, column);
  const PixelFit fitted(stencil, probes, repeating_steps(stencil, probes));
  FittedPixel pixel;
  if (!hit) {
    pixel.radiance = fitted.radiance(few_);
    return pixel;
  }
  pixel.footprint = fitted.footprint(few_);
  pixel.normal = middle.normal;
  const FitLimits limits{pixels_.tolerance, std::max(1, pixels_.subpixels * pixels_.subpixels)};
  const std::vector<bool> edges = probes_->edges(row, column);
  const auto asks = [&](std::size_t part) {
    return !edges[part] && (!fitted.sees(part) || (fitted.penumbra_residual(part) <= kMostPenumbraResidual &&
                                                   fitted.ask(part, few_, limits, &pixel.queries)));
  };
  std::size_t seen = 0;
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    const std::uint32_t light = middle.lamps[first].light;  // of which all parts are fitted, or none
    const std::size_t asked = pixel.queries.size();
    bool is_seen = false, is_fitted = true;
    for (end = first; end < edges.size() && middle.lamps[end].light == light; ++end) {
      is_seen = is_seen || edges[end] || fitted.sees(end);
      is_fitted = is_fitted && asks(end);
    }
    seen += is_seen ? 1 : 0;
    if (is_fitted) continue;
    pixel.queries.resize(asked);
    pixel.sampled_lamps.push_back(light);
  }
  if (static_cast<double>(pixel.sampled_lamps.size()) > kMostSampledLamps * static_cast<double>(seen))
    return std::nullopt;
  pixel.radiance = fitted.radiance(few_, pixel.sampled_lamps);
  for (GlintQuery& query : pixel.queries) query.material = middle.material;
  return pixel;
}

/// Pixels without a fit need the samples of all pixels that their filter reaches; with one, of some lamps.
void BlockTracer::place_samples() {
  Lattice& lattice = rows_.lattice;
  lattice.first_sample.assign(lattice.cell(rows_.row_count + margin_, -margin_), Lattice::kNone);
  std::uint32_t count = 0;
  for (int row = -margin_; row < rows_.row_count + margin_; ++row)
    for (int column = -margin_; column < width_ + margin_; ++column) {
      const bool needed = chosen_ ? !(*chosen_)[lattice.cell(row, column)].empty()
                                  : any_around(row, column, [&](int y, int x) {
                                      return is_sampled(y, x) || samples_lamps(y, x);
                                    });
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
    const std::size_t pixel = pixel_of(row, column);
    rows_.fitted[pixel] = 1;
    rows_.radiance[pixel] = fitted->radiance.cast<float>();
    rows_.sampled_lamps[pixel] = fitted->sampled_lamps;
    PixelMeans means;
    if (fitted->footprint) means.add(*fitted->footprint, fitted->normal);
    means.write(&rows_, pixel);
    for (GlintQuery& query : fitted->queries) {
      query.pixel = static_cast<std::uint32_t>(pixel);
      if (query.weight.maxCoeff() > 0) queries->glints.push_back(query);
    }
    rows_.query_count[pixel] =
        static_cast<std::uint16_t>(std::min<std::size_t>(fitted->queries.size(), 65535));
  }
}

void BlockTracer::sample_row(int row, RowQueries* queries) {
  for (int column = -margin_; column < width_ + margin_; ++column) {
    const std::uint32_t first = rows_.lattice.first_sample[rows_.lattice.cell(row, column)];
    if (first != Lattice::kNone) sample_cell(row, column, first, queries);
  }
}

WantedLamps BlockTracer::wanted_lamps(int row, int column) const {
  WantedLamps wanted{chosen_ != nullptr, {}};
  if (wanted.all) return wanted;
  std::vector<bool> some(viewer_.lights.size(), false);
  any_around(row, column, [&](int y, int x) {
    wanted.all = wanted.all || is_sampled(y, x);
    if (samples_lamps(y, x))
      for (const std::uint32_t lamp : fits_.at(y, x)->sampled_lamps) some[lamp] = true;
    return false;
  });
  for (std::uint32_t lamp = 0; lamp < some.size(); ++lamp)
    if (some[lamp]) wanted.some.push_back(lamp);
  return wanted;
}

std::vector<SeenPoint> BlockTracer::look(const Viewer& viewer, int row, int column) const {
  const int n = pixels_.subpixels;
  std::vector<SeenPoint> points;
  for (int k = 0; k < n * n; ++k) {
    const int right = k % n, down = k / n;
    if (!is_seen(row * n + down, column * n + right) || !is_near_chosen(row, column, k)) {
      points.emplace_back();
      continue;
    }
    points.push_back(viewer.look(first_column_ + column + (right + 0.5) / n,
                                 first_row_ + row + (down + 0.5) / n,
                                 {{light_sample(key(row, column), k, n)}, pixels_.lamp_parts}));
  }
  return points;
}

void BlockTracer::sample_cell(int row, int column, std::uint32_t first_sample, RowQueries* queries) {
  const WantedLamps wanted = wanted_lamps(row, column);
  Viewer viewer = viewer_;
  if (!wanted.all) viewer.lights = lights_of(wanted.some);
  const std::vector<SeenPoint> points = look(viewer, row, column);
  const std::vector<std::vector<Eigen::Matrix2d>> turns = turns_of(points);
  // A pixel that was fitted has queries of its own: samples in it are there for its neighbours.
  const bool owned = is_of_block(row, column) && !has_fit(row, column);
  const auto pixel = owned ? static_cast<std::uint32_t>(pixel_of(row, column)) : GlintQuery::kNone;
  const std::size_t before = queries->size(), first_glint = queries->glints.size();
  PixelMeans means;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SeenPoint& point = points[k];
    const auto sample = first_sample + static_cast<std::uint32_t>(k);
    rows_.sample_radiance[sample] = point.radiance.cast<float>();
    if (!point.hit || !is_chosen(row, column, static_cast<int>(k))) continue;
    means.add({wrap(point.uv), footprint_covariance(point.duv, lattice_filter_.sigma_pixels)}, point.frame.z);
    if (!point.faces_eye) continue;
    SamplePlace place{pixel, sample, key(row, column), static_cast<std::uint32_t>(k)};
    if (pixels_.asks_hidden) {
      const int here = static_cast<int>(k);
      place.missed =
          static_cast<float>(missed_by_bend(points, pixels_.subpixels, here, lattice_filter_.sigma_pixels));
      place.asked_if_hidden = lights_beside(points, pixels_.subpixels, here, viewer.lights.size());
    }
    viewer.ask(point, lattice_filter_.sigma_pixels, place, turns[k], queries);
    for (const SeenLamp& lamp : point.lamps) {
      const std::uint32_t light = wanted.all ? lamp.light : wanted.some[lamp.light];
      if (lamp.visible > 0 && std::binary_search(wanted.some.begin(), wanted.some.end(), light))
        queries->lamp_samples.push_back(
            {sample, light, lamp.seen.smooth.cwiseProduct(lamp.incident.irradiance).cast<float>()});
    }
  }
  for (std::size_t n = first_glint; n < queries->glints.size() && !wanted.all; ++n)
    queries->glints[n].light = wanted.some[queries->glints[n].light];
  if (samples_lamps(row, column) && is_of_block(row, column)) own_lamps(row, column, first_glint, queries);
  if (!owned) return;
  means.write(&rows_, pixel);
  rows_.query_count[pixel] =
      static_cast<std::uint16_t>(std::min<std::size_t>(queries->size() - before, 65535));
}

/// Samples of a fitted pixel belong to it where they are of lamps that it needs them of.
void BlockTracer::own_lamps(int row, int column, std::size_t first_glint, RowQueries* queries) {
  const std::vector<std::uint32_t>& lamps = fits_.at(row, column)->sampled_lamps;
  const std::size_t pixel = pixel_of(row, column);
  for (std::size_t n = first_glint; n < queries->glints.size(); ++n) {
    GlintQuery& query = queries->glints[n];
    if (query.hidden_weight > 0 || !std::binary_search(lamps.begin(), lamps.end(), query.light)) continue;
    query.pixel = static_cast<std::uint32_t>(pixel);
    if (rows_.query_count[pixel] < 65535) ++rows_.query_count[pixel];
  }
}

/// The half vectors' turns over the samples of a pixel, by sample and lamp.
std::vector<std::vector<Eigen::Matrix2d>> BlockTracer::turns_of(const std::vector<SeenPoint>& points) const {
  std::vector<std::vector<Eigen::Matrix2d>> turns(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SeenPoint& point = points[k];
    if (!point.hit || !point.faces_eye || !pixels_.takes_first_order[point.material]) continue;
    turns[k].assign(point.lamps.size(), Eigen::Matrix2d::Zero());
    for (std::size_t lamp = 0; lamp < point.lamps.size(); ++lamp) {
      if (!pixels_.turns || !point.lamps[lamp].is_above) continue;
      const auto change = half_vector_change(points, pixels_.subpixels, static_cast<int>(k), lamp,
                                             lattice_filter_.sigma_pixels);
      const double least = kLeastTurn * point.lamps[lamp].seen.roughness / lattice_filter_.sigma_pixels;
      if (change && change->norm() > least)
        turns[k][lamp] = turn_over(point.duv, *change, lattice_filter_.sigma_pixels);
    }
  }
  return turns;
}

}  // namespace

TracedRows trace_rows(const Viewer& viewer, const PixelSettings& pixels, const ImagePart& part) {
  return BlockTracer(viewer, pixels, part).trace();
}

TracedRows sample_rows(const Viewer& viewer, const PixelSettings& pixels, const ImagePart& part,
                       const Lattice::Choice& chosen) {
  return BlockTracer(viewer, pixels, part).sample(chosen);
}

}  // namespace mica::host
