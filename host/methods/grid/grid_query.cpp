#include "host/methods/grid/grid_query.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include "host/methods/grid/glint_turn.h"
#include "host/methods/map/turned_query.h"

namespace mica::host {
namespace {

using namespace device_types;

constexpr double kCellsASigma = 8;                  // of the finer level, at the weight of one
constexpr double kLeastSigma = 1.0 / 128;           // cells
constexpr double kLeastLobe = 1e-4, kMostLobe = 1;  // standard deviations of a glint's lobe
constexpr double kMaxLevel = 24;                    // angular cells narrower than 2^-24 are beyond a float

bool outside(double value, double low, double high) {
  return !(value >= low && value <= high);
}

/// Writes one query of a batch.
class Column {
 public:
  Column(GridBatch* batch, std::size_t n) : batch_(batch), n_(n) {}
  void copy_previous() {  // but for what a turn adds
    for (std::size_t field = 0; field < MICA_GLINT_FIELDS; ++field)
      batch_->fields[field * batch_->pitch + n_] = batch_->fields[field * batch_->pitch + n_ - 1];
  }
  void set(int field, std::int32_t value) { batch_->fields[field * batch_->pitch + n_] = value; }
  void set(int field, double value) {
    const float single = static_cast<float>(value);
    std::memcpy(&batch_->fields[field * batch_->pitch + n_], &single, sizeof single);
  }

 private:
  GridBatch* batch_;
  std::size_t n_;
};

/// A coordinate as a cell, modulo 2^32, and the fraction in it, which rounds to less than one.
void set_cell(Column* column, int cell_field, int fraction_field, double cells) {
  const double whole = std::floor(cells);
  column->set(cell_field,
              static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::int64_t>(whole))));
  column->set(fraction_field, std::min(cells - whole, 1 - 0x1p-24));
}

/// All but the half vector, its turn and the lobe that a turned query has. Returns the footprint's axes, in
/// the order of the rows of W: columns of one standard deviation each, in uv.
Eigen::Matrix2d set_footprint(const Query& query, const GlintPoint& glints, Column* column) {
  // From uv to cells of level 0: A* with determinant one, then the resolution [Kem25 Algorithm 1].
  const double resolution = std::sqrt(double{glints.density}), stretch = std::sqrt(double{glints.stretch});
  const Eigen::Vector2d scale(resolution / stretch, resolution * stretch);
  const Eigen::Matrix2d& c = query.footprint.cov_uv;
  const double xx = c(0, 0) * scale.x() * scale.x(), yy = c(1, 1) * scale.y() * scale.y();
  const double xy = c(0, 1) * scale.x() * scale.y();
  const double middle = 0.5 * (xx + yy), difference = 0.5 * (xx - yy);
  const double major2 = middle + std::hypot(difference, xy);
  const double minor2 = major2 > 0 ? std::max((xx * yy - xy * xy) / major2, 0.0) : 0.0;
  const double angle = 0.5 * std::atan2(xy, difference), cosine = std::cos(angle), sine = std::sin(angle);

  const double detail =
      std::clamp(0.5 * std::log2(kCellsASigma * kCellsASigma * std::max(major2, 1e-100)), 0.0, kMaxLevel);
  const int level = static_cast<int>(detail);
  const double cell = std::exp2(-level);  // of level 0, in cells of this one
  const auto inverse_sigma = [&](double sigma2) {
    return 1 / std::sqrt(sigma2 * cell * cell + kLeastSigma * kLeastSigma);
  };
  const double inverse_major =
      inverse_sigma(std::min(major2, std::exp2(2 * kMaxLevel) / (kCellsASigma * kCellsASigma) * 4));
  const double inverse_minor =
      inverse_sigma(std::min(minor2, std::exp2(2 * kMaxLevel) / (kCellsASigma * kCellsASigma) * 4));

  set_cell(column, MICA_GLINT_CELL_I, MICA_GLINT_FRACTION_X, query.footprint.mean_uv.x() * scale.x() * cell);
  set_cell(column, MICA_GLINT_CELL_J, MICA_GLINT_FRACTION_Y, query.footprint.mean_uv.y() * scale.y() * cell);
  column->set(MICA_GLINT_WHITEN_1X, cosine * inverse_major);
  column->set(MICA_GLINT_WHITEN_1Y, sine * inverse_major);
  column->set(MICA_GLINT_WHITEN_2X, -sine * inverse_minor);
  column->set(MICA_GLINT_WHITEN_2Y, cosine * inverse_minor);
  column->set(MICA_GLINT_LEVEL, level);
  column->set(MICA_GLINT_WEIGHT, 1 - (detail - level));
  column->set(MICA_GLINT_INVERSE_ALPHA_X, 1.0 / glints.alpha_x);
  column->set(MICA_GLINT_INVERSE_ALPHA_Y, 1.0 / glints.alpha_y);
  column->set(MICA_GLINT_MICRO_S, query.roughness / stretch);
  column->set(MICA_GLINT_MICRO_T, query.roughness * stretch);
  column->set(MICA_GLINT_SEED, static_cast<std::int32_t>(glints.seed));
  column->set(MICA_GLINT_SHARE, double{glints.share});
  column->set(MICA_GLINT_PRESENCE, double{glints.share} * glints.kept);
  column->set(MICA_GLINT_BRIGHTNESS, 1.0 / glints.kept);
  Eigen::Matrix2d axes;
  axes << cosine, -sine, sine, cosine;
  return scale.cwiseInverse().asDiagonal() * axes *
         Eigen::Vector2d(std::sqrt(major2), std::sqrt(minor2)).asDiagonal();
}

void set_turn(const Query& query, const GlintPoint& glints, const Eigen::Matrix2d& axes, Column* column) {
  const GlintTurn turn = glint_turn(query, glints, axes);
  column->set(MICA_GLINT_LOBE_A, turn.lobe(0, 0));
  column->set(MICA_GLINT_LOBE_B, turn.lobe(1, 1));
  column->set(MICA_GLINT_LOBE_SHEAR, turn.lobe(1, 0) / turn.lobe(1, 1));
  column->set(MICA_GLINT_TURN_A1, turn.turn(0, 0));
  column->set(MICA_GLINT_TURN_A2, turn.turn(0, 1));
  column->set(MICA_GLINT_TURN_B1, turn.turn(1, 0));
  column->set(MICA_GLINT_TURN_B2, turn.turn(1, 1));
  column->set(MICA_GLINT_SPREAD_A, turn.spread.x());
  column->set(MICA_GLINT_SPREAD_B, turn.spread.y());
  const double cosine = std::sqrt((1 - turn.correlation) * (1 + turn.correlation));
  column->set(MICA_GLINT_SPREAD_TANGENT, turn.correlation / (1 + cosine));
  column->set(MICA_GLINT_DENSITY, turn.smooth_density);
}

/// Whether two queries differ at most in their half vectors, as those of one footprint to many lights do.
bool share_footprint(const Query& a, const Query& b) {
  return a.footprint.mean_uv == b.footprint.mean_uv && a.footprint.cov_uv == b.footprint.cov_uv &&
         a.roughness == b.roughness;
}
bool are_same(const GlintPoint& a, const GlintPoint& b) {
  const auto members = [](const GlintPoint& p) {
    return std::tie(p.distribution, p.alpha_x, p.alpha_y, p.density, p.stretch, p.share, p.kept, p.seed);
  };
  return members(a) == members(b);
}

}  // namespace

GlintPoint GlintGrid::point() const {
  GlintPoint point;
  point.distribution = distribution;
  point.alpha_x = static_cast<float>(alpha_x), point.alpha_y = static_cast<float>(alpha_y);
  point.density = static_cast<float>(density);
  point.stretch = static_cast<float>(stretch);
  point.seed = seed;
  return point;
}

std::string glint_grid_problem(const GlintGrid& grid) {
  if (outside(grid.alpha_x, 1e-4, 1) || outside(grid.alpha_y, 1e-4, 1))
    return fmt::format("roughness ({}, {}) is outside of 1e-4 to 1", grid.alpha_x, grid.alpha_y);
  if (outside(grid.density, 1, 1e12)) return fmt::format("density {} is outside of 1 to 1e12", grid.density);
  if (outside(grid.stretch, 1.0 / 64, 64))
    return fmt::format("stretch {} is outside of 1/64 to 64", grid.stretch);
  return "";
}

std::string grid_query_problem(const Query& query) {
  const Eigen::Matrix2d& c = query.footprint.cov_uv;
  if (!query.footprint.mean_uv.allFinite() || query.footprint.mean_uv.cwiseAbs().maxCoeff() > 1e7)
    return "uv is outside of -1e7 to 1e7";
  const double scale = c.cwiseAbs().maxCoeff();
  if (!c.allFinite() || c(0, 0) < 0 || c(1, 1) < 0 || c.determinant() < -1e-12 * scale * scale)
    return "covariance is not positive semidefinite";
  if (scale > 1e14) return "covariance is above 1e14";
  if (!query.half_vector.allFinite() || query.half_vector.cwiseAbs().maxCoeff() > 1)
    return "half vector is outside of [-1, 1]^2";
  if (!query.lobe_cov && outside(query.roughness, kLeastLobe, kMostLobe))
    return fmt::format("roughness {} is outside of 1e-4 to 1", query.roughness);
  const std::string problem = query.lobe_cov ? lobe_problem(query, kLeastLobe, kMostLobe) : "";
  return problem.empty() ? turn_problem(query) : problem;
}

GridBatch to_grid_batch(const std::vector<Query>& queries, std::size_t first, std::size_t count,
                        const std::vector<GlintPoint>& points, bool turned) {
  GridBatch batch;
  batch.pitch = (count + MICA_GLINT_PADDING - 1) / MICA_GLINT_PADDING * MICA_GLINT_PADDING;
  batch.fields.resize((turned ? MICA_GLINT_TURNED_FIELDS : MICA_GLINT_FIELDS) * batch.pitch);
  const Query padding;
  const auto query_of = [&](std::size_t n) -> const Query& {
    return n < count ? queries[first + n] : padding;
  };
  const auto glints_of = [&](std::size_t n) -> const GlintPoint& {
    return points.size() == 1 || n >= count ? points.front() : points[first + n];
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, batch.pitch), [&](const auto& range) {
    Eigen::Matrix2d axes;
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      const Query& query = query_of(n);
      Column column(&batch, n);
      if (n > range.begin() && share_footprint(query, query_of(n - 1)) &&
          are_same(glints_of(n), glints_of(n - 1))) {
        column.copy_previous();
      } else {
        axes = set_footprint(query, glints_of(n), &column);
      }
      if (turned) set_turn(query, glints_of(n), axes, &column);
      column.set(MICA_GLINT_HALF_S, query.half_vector.x());
      column.set(MICA_GLINT_HALF_T, query.half_vector.y());
    }
  });
  return batch;
}

}  // namespace mica::host
