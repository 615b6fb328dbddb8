#include "host/gbuffer/trace_buffer.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/base/constants.h"
#include "host/gbuffer/surface_gradient.h"
#include "host/microfacet/horizon.h"
#include "host/scene/block_rows.h"
#include "host/scene/footprint.h"
#include "host/scene/light_samples.h"
#include "host/scene/pixel_fit.h"
#include "host/scene/wrap.h"

namespace mica::host {
namespace {

constexpr int kMostParts = 16;        // of a pixel and lamp, as of a picture's four subpixels
constexpr double kMostLeftOut = 0.3;  // by a fit, relative L2; beyond it there is none
constexpr double kPlaneStep = 1e-5;   // of the distance to the eye: less than a pixel

/// Where a layer's rows lie in a G-buffer.
struct LayerPart {
  int width, height;  ///< of the layer
  int first_row, row_count, scale;
};

/// All steps of a block of the layer's rows. Rows and columns of points are those of the buffer; cells are
/// the layer's pixels, whose rows count from the block's first one.
class BufferBlock {
 public:
  BufferBlock(GBuffer* buffer, const BufferView& view, const Scene& scene, const LayerPart& part)
      : view_(view),
        viewer_(scene.viewer()),
        pixels_(scene.pixels()),
        part_(part),
        scale_(part.scale),
        lattice_filter_(scale_ > 1 ? pixels_.filter.for_layer().on_lattice(scale_)
                                   : FilterSum{0, {0}, {1}, 0}),
        margin_(scale_ > 1 ? pixels_.filter.for_layer().margin_pixels() : 0),
        filter_(scale_ > 1 ? FilterSum{lattice_filter_.sigma_pixels * scale_, {0}, {1}, 0}
                           : pixels_.filter.by_few()),
        sigma_pixels_(std::sqrt(filter_.variance())),
        first_cell_(std::max(-margin_, -part.first_row)),
        end_cell_(std::min(part.row_count + margin_, part.height - part.first_row)),
        first_point_((part.first_row + first_cell_) * scale_),
        end_point_((part.first_row + end_cell_) * scale_),
        columns_(part.width * scale_),
        buffer_(buffer->read(first_point_ - 2, end_point_ - first_point_ + 4, 2)),
        gradients_(first_point_ - 1, end_point_ - first_point_ + 2, -1, columns_ + 2),
        probes_(first_point_ - 1, end_point_ - first_point_ + 2, -1, columns_ + 2),
        rows_(empty_rows(part.first_row, part.row_count, part.width)) {
    for (std::size_t lamp = 0; lamp < view.lamps.size(); ++lamp)
      knows_shadows_.push_back(buffer->knows_shadows_of(lamp));
  }

  TracedRows trace(BufferCounts* counts_of_rows) {
    place_samples();
    tbb::parallel_for(first_point_ - 1, end_point_ + 1, [&](int row) {
      for (int column = -1; column <= columns_; ++column) probe(row, column);
    });
    std::vector<RowQueries> queries(static_cast<std::size_t>(end_cell_ - first_cell_));
    tbb::parallel_for(first_cell_, end_cell_, [&](int row) {
      BufferCounts counts;
      for (int column = 0; column < part_.width; ++column)
        ask_cell(row, column, &counts, &queries[static_cast<std::size_t>(row - first_cell_)]);
      if (row >= 0 && row < part_.row_count) counts_of_rows[row] = counts;
    });
    join_queries(&queries, &rows_);
    cover();
    return std::move(rows_);
  }

 private:
  bool is_point(int row, int column) const {
    return buffer_.pixels.at(row, column).material != BufferPixel::kNothing;
  }
  void place_samples();
  void probe(int row, int column);
  SeenPoint point_at(int row, int column) const;
  void see_lamps(SeenPoint* point) const;
  double seen_share(int row, int column, const SeenPoint& point, std::size_t lamp) const;
  void ask_cell(int row, int column, BufferCounts* counts, RowQueries* queries);
  std::optional<Footprint> ask_point(int row, int column, const SamplePlace& place,
                                     RowQueries* queries) const;
  void ask_without_fit(int row, int column, const SamplePlace& place, const std::vector<double>& shares,
                       SeenPoint* point, RowQueries* queries) const;
  std::optional<PixelFit> fit(int row, int column) const;
  bool all_see(int row, int column, std::size_t lamp) const;
  bool ask_fit(const PixelFit& fitted, std::size_t lamp, const SeenPoint& point, double share,
               const SamplePlace& place, RowQueries* queries) const;
  std::array<SeenPoint, 2> steps_on_plane(const SeenPoint& point, const SurfaceGradient& gradient) const;
  bool turns_linearly(int row, int column, const SeenPoint& point) const;
  Eigen::Matrix2d turn_at(int row, int column, std::size_t lamp, const SeenPoint& point,
                          const std::array<SeenPoint, 2>& beside) const;
  void cover();

  const BufferView& view_;
  const Viewer& viewer_;
  const PixelSettings& pixels_;
  const LayerPart part_;
  const int scale_;
  const FilterSum lattice_filter_;  // of the layer's pixels over cells
  const int margin_;
  const FilterSum filter_;  // of a point, in pixels of the buffer
  const double sigma_pixels_;
  const int first_cell_, end_cell_;    // rows of cells that the block has to know of
  const int first_point_, end_point_;  // rows of the buffer in them
  const int columns_;
  const BufferRows buffer_;
  std::vector<bool> knows_shadows_;  // by lamp
  Rectangle<SurfaceGradient> gradients_;
  Rectangle<Probe> probes_;
  TracedRows rows_;
  std::vector<std::uint8_t> covered_;  // by sample
};

/// All cells of the block are sampled. Beyond the buffer its edge goes on.
void BufferBlock::place_samples() {
  Lattice& lattice = rows_.lattice;
  lattice = {part_.width, margin_, scale_, lattice_filter_, {}};
  lattice.first_sample.assign(lattice.cell(part_.row_count + margin_, -margin_), Lattice::kNone);
  const auto samples_a_cell = static_cast<std::uint32_t>(scale_ * scale_);
  for (int row = -margin_; row < part_.row_count + margin_; ++row)
    for (int column = -margin_; column < part_.width + margin_; ++column) {
      const int of_row = std::clamp(row, first_cell_, end_cell_ - 1) - first_cell_;
      const int of_column = std::clamp(column, 0, part_.width - 1);
      lattice.first_sample[lattice.cell(row, column)] =
          static_cast<std::uint32_t>(of_row * part_.width + of_column) * samples_a_cell;
    }
  const std::size_t count = static_cast<std::size_t>(end_cell_ - first_cell_) *
                            static_cast<std::size_t>(part_.width) * samples_a_cell;
  rows_.sample_radiance.assign(count, Eigen::Vector3f::Zero());
  covered_.assign(count, 0);
}

void BufferBlock::probe(int row, int column) {
  if (!is_point(row, column)) return;
  gradients_.at(row, column) = surface_gradient(buffer_.pixels, row, column);
  SeenPoint point = point_at(row, column);
  see_lamps(&point);
  probes_.at(row, column) = probe_of(point);
}

SeenPoint BufferBlock::point_at(int row, int column) const {
  const BufferPixel& pixel = buffer_.pixels.at(row, column);
  const SurfaceGradient& gradient = gradients_.at(row, column);
  Hit hit = hit_of(pixel, gradient);

  SeenPoint point;
  const BufferCamera::Sight sight = view_.camera.sight(hit.position);
  point.ray = sight.ray, hit.t = sight.t;
  point.material = static_cast<std::uint32_t>(pixel.material);
  point.to_eye = -point.ray.direction.normalized();
  point.frame = tangent_frame(hit, point.to_eye);
  const Eigen::Vector2d& repeat = viewer_.shared->materials[point.material].repeat;
  point.uv = hit.uv.cwiseProduct(repeat);
  const Eigen::Matrix<double, 3, 2> step = position_differentials(point.ray, hit);
  Eigen::Matrix2d on_plane;
  on_plane << gradient.on_plane(step.col(0)), gradient.on_plane(step.col(1));
  point.duv = repeat.asDiagonal() * gradient.duv * on_plane;
  point.faces_eye = point.frame.face_normal.dot(point.to_eye) >= kMinCosine;
  point.hit = hit;
  return point;
}

/// Without shadows, which the buffer knows of at the pixel itself.
void BufferBlock::see_lamps(SeenPoint* point) const {
  if (!point->faces_eye) return;
  viewer_.see_lamps({{{0, 0}}, {}}, point);
  for (std::size_t n = 0; n < point->lamps.size(); ++n) {
    if (!view_.lamps[n].cone) continue;
    const double share = view_.lamps[n].cone->share(point->hit->position);
    point->lamps[n].visible *= share;
    point->lamps[n].incident.irradiance *= share;
  }
}

/// The share of a lamp that no shadow hides: what arrives at a white diffuse surface beside what would.
double BufferBlock::seen_share(int row, int column, const SeenPoint& point, std::size_t lamp) const {
  if (!knows_shadows_[lamp]) return 1;
  const Illumination incident = illuminate(view_.lamps[lamp].light, point.hit->position);
  const std::optional<SpotCone>& cone = view_.lamps[lamp].cone;
  const double unshadowed = incident.irradiance.sum() * incident.direction.dot(point.frame.z) *
                            (cone ? cone->share(point.hit->position) : 1);
  const double seen = kPi * buffer_.lamp_light[lamp].at(row, column);
  return unshadowed > 0 && seen > 0 ? std::min(seen / unshadowed, 1.0) : 0;
}

void BufferBlock::ask_cell(int row, int column, BufferCounts* counts, RowQueries* queries) {
  const bool owned = row >= 0 && row < part_.row_count;
  const auto pixel = owned ? static_cast<std::uint32_t>(row * part_.width + column) : GlintQuery::kNone;
  const std::uint32_t first_sample = rows_.lattice.first_sample[rows_.lattice.cell(row, column)];
  const std::uint64_t key = place_key(part_.first_row + row, column, part_.width);
  const std::size_t before = queries->size();
  PixelMeans means;
  for (int n = 0; n < scale_ * scale_; ++n) {
    const int down = (part_.first_row + row) * scale_ + n / scale_, right = column * scale_ + n % scale_;
    counts->broken += buffer_.pixels.at(down, right).is_broken;
    if (!is_point(down, right)) continue;
    const auto subpixel = static_cast<std::uint32_t>(n), sample = first_sample + subpixel;
    const SurfaceGradient& gradient = gradients_.at(down, right);
    covered_[sample] = 1;
    ++counts->covered;
    counts->alone += !gradient.is_known;
    counts->one_sided += gradient.is_known && !gradient.has_all();
    if (const auto footprint = ask_point(down, right, {pixel, sample, key, subpixel}, queries))
      means.add(*footprint, probes_.at(down, right).normal);
  }
  if (!owned) return;
  means.write(&rows_, pixel);
  rows_.query_count[pixel] =
      static_cast<std::uint16_t>(std::min<std::size_t>(queries->size() - before, 65535));
}

/// Queries for all lamps. @return its footprint; none where it is not known or turned away.
std::optional<Footprint> BufferBlock::ask_point(int row, int column, const SamplePlace& place,
                                                RowQueries* queries) const {
  if (!gradients_.at(row, column).is_known) return std::nullopt;
  SeenPoint point = point_at(row, column);
  if (!point.faces_eye) return std::nullopt;
  const std::optional<PixelFit> fitted = fit(row, column);
  std::vector<double> shares;  // that the fit does not answer for
  for (std::size_t lamp = 0; lamp < view_.lamps.size(); ++lamp) {
    const double share = seen_share(row, column, point, lamp);
    const bool is_asked = share > 0 && fitted && all_see(row, column, lamp) &&
                          ask_fit(*fitted, lamp, point, share, place, queries);
    shares.push_back(is_asked ? 0 : share);
  }
  if (std::any_of(shares.begin(), shares.end(), [](double share) { return share > 0; }))
    ask_without_fit(row, column, place, shares, &point, queries);
  return fitted ? fitted->footprint(filter_)
                : Footprint{wrap(point.uv), footprint_covariance(point.duv, sigma_pixels_)};
}

void BufferBlock::ask_without_fit(int row, int column, const SamplePlace& place,
                                  const std::vector<double>& shares, SeenPoint* point,
                                  RowQueries* queries) const {
  see_lamps(point);
  std::vector<Eigen::Matrix2d> turns(shares.size(), Eigen::Matrix2d::Zero());
  const std::array<SeenPoint, 2> beside = steps_on_plane(*point, gradients_.at(row, column));
  const bool is_linear = turns_linearly(row, column, *point);
  for (std::size_t lamp = 0; lamp < shares.size(); ++lamp) {
    SeenLamp& seen = point->lamps[lamp];
    seen.visible *= shares[lamp];
    seen.incident.irradiance *= shares[lamp];
    if (seen.visible > 0 && is_linear && pixels_.takes_first_order[point->material])
      turns[lamp] = turn_at(row, column, lamp, *point, beside);
  }
  viewer_.ask(*point, sigma_pixels_, place, turns, queries);
}

std::optional<PixelFit> BufferBlock::fit(int row, int column) const {
  const FitStencil& stencil = FitStencil::centers();
  const Probe& middle = probes_.at(row, column);
  if (!pixels_.takes_first_order[middle.material] || !gradients_.at(row, column).has_all())
    return std::nullopt;
  ProbesOfFit probes;
  UvSteps steps;
  const Eigen::Vector2d& repeat = viewer_.shared->materials[middle.material].repeat;
  for (std::size_t n = 0; n < stencil.size(); ++n) {
    const int down = row + static_cast<int>(stencil.offsets()[n].y());
    const int right = column + static_cast<int>(stencil.offsets()[n].x());
    probes[n] = &probes_.at(down, right);
    steps[n] = uv_step(buffer_.pixels.at(row, column), buffer_.pixels.at(down, right)).cwiseProduct(repeat);
    if (!probes[n]->faces_eye) return std::nullopt;
  }
  return PixelFit(stencil, probes, steps);
}

bool BufferBlock::all_see(int row, int column, std::size_t lamp) const {
  for (int down = -1; down <= 1; ++down)
    for (int right = -1; right <= 1; ++right)
      if (!(probes_.at(row + down, column + right).lamps[lamp].visible > 0)) return false;
  return true;
}

/// A fit that keeps the tolerance, or else the best that there is while it is one at all.
bool BufferBlock::ask_fit(const PixelFit& fitted, std::size_t lamp, const SeenPoint& point, double share,
                          const SamplePlace& place, RowQueries* queries) const {
  std::vector<GlintQuery> asked;
  const FitLimits limits{pixels_.tolerance, kMostParts};
  const FitLimits most{kMostLeftOut, kMostParts};
  if (!fitted.ask(lamp, filter_, limits, &asked) && !fitted.ask(lamp, filter_, most, &asked)) return false;
  for (GlintQuery& query : asked) {
    query.pixel = place.pixel, query.sample = place.sample, query.material = point.material;
    query.weight *= static_cast<float>(share);
    if (query.weight.maxCoeff() > 0) queries->glints.push_back(query);
  }
  return true;
}

/// What would be seen a small step along each axis of the surface's plane, if it went on as that.
std::array<SeenPoint, 2> BufferBlock::steps_on_plane(const SeenPoint& point,
                                                     const SurfaceGradient& gradient) const {
  std::array<SeenPoint, 2> beside = {point, point};
  for (std::size_t axis = 0; axis < beside.size(); ++axis) {
    SeenPoint& moved = beside[axis];
    moved.hit->position += kPlaneStep * point.hit->t * (axis == 0 ? gradient.x : gradient.y);
    moved.ray = view_.camera.sight(moved.hit->position).ray;
    moved.to_eye = -moved.ray.direction.normalized();
    moved.lamps.clear();
    see_lamps(&moved);
  }
  return beside;
}

/// Whether half vectors turn linearly over a footprint: not towards rims, where nothing does.
bool BufferBlock::turns_linearly(int row, int column, const SeenPoint& point) const {
  const std::vector<Eigen::Vector2d>& offsets = FitStencil::centers().offsets();
  const double cosine = point.frame.z.dot(point.to_eye);
  for (std::size_t n = 1; n < offsets.size(); ++n) {
    if (!gradients_.at(row, column).is_near[n]) continue;
    const int down = row + static_cast<int>(offsets[n].y()),
              right = column + static_cast<int>(offsets[n].x());
    const Eigen::Vector3d position = buffer_.pixels.at(down, right).position.cast<double>();
    const Eigen::Vector3d to_eye = -view_.camera.sight(position).ray.direction.normalized();
    const double change = std::abs(probes_.at(down, right).normal.dot(to_eye) - cosine) / offsets[n].norm();
    if (!(sigma_pixels_ * change < kMostForeshortening * cosine)) return false;
  }
  return true;
}

/// As on the plane, and besides what neighbours say of how the normal turns along the lines to them.
Eigen::Matrix2d BufferBlock::turn_at(int row, int column, std::size_t lamp, const SeenPoint& point,
                                     const std::array<SeenPoint, 2>& beside) const {
  const std::vector<Eigen::Vector2d>& offsets = FitStencil::centers().offsets();
  const SurfaceGradient& gradient = gradients_.at(row, column);
  const Eigen::Vector2d& half_vector = point.lamps[lamp].half_vector;
  Eigen::Matrix2d on_plane = Eigen::Matrix2d::Zero();
  for (Eigen::Index axis = 0; axis < 2; ++axis)
    if (const SeenLamp& seen = beside[static_cast<std::size_t>(axis)].lamps[lamp]; seen.visible > 0)
      on_plane.col(axis) = (seen.half_vector - half_vector) / (kPlaneStep * point.hit->t);
  PlaneGradient of_normal;
  for (std::size_t n = 1; n < offsets.size(); ++n) {
    if (!gradient.is_near[n]) continue;
    const int down = row + static_cast<int>(offsets[n].y()),
              right = column + static_cast<int>(offsets[n].x());
    const Probe& other = probes_.at(down, right);
    if (!other.faces_eye || !(other.lamps[lamp].visible > 0)) continue;
    const Eigen::Vector3d step = buffer_.pixels.at(down, right).position.cast<double>() - point.hit->position;
    const Eigen::Vector2d place = gradient.on_plane(step);
    of_normal.add(place, other.lamps[lamp].half_vector - half_vector - on_plane * place,
                  offsets[n].squaredNorm());
  }
  const Eigen::Matrix2d repeat_inverse =
      viewer_.shared->materials[point.material].repeat.cwiseInverse().asDiagonal();
  // The half vector's change a pixel, by the change of uv a pixel that belongs to it.
  const Eigen::Matrix2d change =
      (on_plane + of_normal.value()) * gradient.duv.inverse() * repeat_inverse * point.duv;
  const double least = kLeastTurn * point.lamps[lamp].seen.roughness / sigma_pixels_;
  return change.norm() > least ? turn_over(point.duv, change, sigma_pixels_)
                               : Eigen::Matrix2d(Eigen::Matrix2d::Zero());
}

void BufferBlock::cover() {
  const auto width = static_cast<std::size_t>(part_.width);
  rows_.coverage.assign(rows_.radiance.size(), 0);
  for (std::size_t pixel = 0; pixel < rows_.coverage.size(); ++pixel) {
    double share = 0;
    rows_.lattice.sum(static_cast<int>(pixel / width), static_cast<int>(pixel % width), rows_.lattice.all(),
                      [&](std::size_t sample, double weight) { share += weight * covered_[sample]; });
    rows_.coverage[pixel] = static_cast<float>(share);
  }
}

}  // namespace

BufferCounts& BufferCounts::operator+=(const BufferCounts& other) {
  covered += other.covered, one_sided += other.one_sided, alone += other.alone, broken += other.broken;
  return *this;
}

BufferTracer::BufferTracer(GBuffer* buffer, const BufferView& view, int scale)
    : buffer_(buffer),
      view_(view),
      scale_(scale),
      width_(buffer->window().width / scale),
      height_(buffer->window().height / scale),
      counts_(static_cast<std::size_t>(height_)) {}

TracedRows BufferTracer::trace(const Scene& scene, int first_row, int row_count) {
  return BufferBlock(buffer_, view_, scene, {width_, height_, first_row, row_count, scale_})
      .trace(counts_.data() + first_row);
}

BufferCounts BufferTracer::counts() const {
  return std::accumulate(counts_.begin(), counts_.end(), BufferCounts(),
                         [](BufferCounts sum, const BufferCounts& row) { return sum += row; });
}

}  // namespace mica::host
