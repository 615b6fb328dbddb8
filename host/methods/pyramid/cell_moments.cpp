#include "host/methods/pyramid/cell_moments.h"

#include <algorithm>
#include <cmath>

#include "host/surface/interpolate.h"

namespace mica::host {
namespace {

/// Normals may change by this much, in cells, over a piece of a triangle.
constexpr double kPieceCells = 1.0;
/// A triangle is cut into at most the square of this many pieces alike. Where normals change faster, or
/// hardly along one side, as beside an edge or a scratch, it is cut into strips along that side, and these
/// into pieces.
constexpr int kMostCuts = 8;
constexpr int kMostStrips = 32;

constexpr int kBicubicParts = 4;  // a texel and axis

/// Of the block's mean, the weight that a light cell has at most: on noise a fifth of the cells, and 2% of
/// the weight.
constexpr double kLight = 0.2;

/// 18 times the covariance of a uniform triangle with these two edges.
Eigen::Matrix4d edge_products(const Eigen::Vector4d& ab, const Eigen::Vector4d& ac) {
  return ab * ab.transpose() + ac * ac.transpose() - 0.5 * (ab * ac.transpose() + ac * ab.transpose());
}

/// Of the cells around `part` that are not empty, the one with the nearest mean normal; null without any.
CellMoments* nearest_neighbour(const NormalCells& cells, const CellMoments& part,
                               std::vector<CellMoments>* parts) {
  CellMoments* nearest = nullptr;
  double least = 8 * cells.width() * cells.width();  // farther is the other end of a row of cells
  const Eigen::Vector2d normal = part.moments.mean().tail<2>();
  for (const int row : {-1, 0, 1}) {
    const int first = part.cell + row * cells.columns() - 1;
    auto found = std::lower_bound(parts->begin(), parts->end(), first,
                                  [](const CellMoments& a, int cell) { return a.cell < cell; });
    for (; found != parts->end() && found->cell <= first + 2; ++found) {
      if (&*found == &part || !(found->moments.weight > 0)) continue;
      const double distance = (found->moments.mean().tail<2>() - normal).squaredNorm();
      if (distance < least) nearest = &*found, least = distance;
    }
  }
  return nearest;
}

}  // namespace

NormalCells::NormalCells(const Surface& surface, double width) : width_(width) {
  Eigen::Vector2d low = surface.normals().front(), high = low;
  for (const Eigen::Vector2d& normal : surface.normals()) {
    low = low.cwiseMin(normal);
    high = high.cwiseMax(normal);
  }
  // Bicubic values overshoot: what lies outside falls into the outermost cells.
  low_s_ = low.x(), low_t_ = low.y();
  columns_ = static_cast<int>((high.x() - low.x()) / width) + 1;
  rows_ = static_cast<int>((high.y() - low.y()) / width) + 1;
}

int NormalCells::cell_of(double s, double t) const {
  const int column = std::clamp(static_cast<int>((s - low_s_) / width_), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>((t - low_t_) / width_), 0, rows_ - 1);
  return row * columns_ + column;
}

BlockMoments::BlockMoments(const Surface& surface, const NormalCells& cells)
    : surface_(surface), cells_(cells), place_of_cell_(cells.count(), -1) {}

std::vector<CellMoments> BlockMoments::block(int first_i, int first_j, int size) {
  if (first_i >= surface_.width() || first_j >= surface_.height()) return {};
  if (size < 2 * kBaseBlock) return base_block(first_i, first_j, size);
  const int half = size / 2;
  const std::vector<CellMoments> quarters[] = {
      block(first_i, first_j, half), block(first_i + half, first_j, half),
      block(first_i, first_j + half, half), block(first_i + half, first_j + half, half)};
  return merge({&quarters[0], &quarters[1], &quarters[2], &quarters[3]});
}

std::vector<CellMoments> BlockMoments::merge(const std::vector<const std::vector<CellMoments>*>& quarters) {
  for (const std::vector<CellMoments>* quarter : quarters)
    for (const CellMoments& part : *quarter) at(part.cell).add(part.moments);
  return take();
}

std::vector<CellMoments> BlockMoments::base_block(int first_i, int first_j, int size) {
  for (int j = first_j; j < std::min(first_j + size, surface_.height()); ++j)
    for (int i = first_i; i < std::min(first_i + size, surface_.width()); ++i) add_texel(i, j);
  return take();
}

void BlockMoments::add_texel(long i, long j) {
  const Eigen::Vector2d corner(static_cast<double>(i), static_cast<double>(j));
  if (surface_.interpolation() == Interpolation::nearest) return add_square(corner, surface_.texel(i, j));
  const bool bicubic = surface_.interpolation() == Interpolation::bicubic;
  const int parts = bicubic ? kBicubicParts : 1;
  const auto vertex = [&](int a, int b) -> Eigen::Vector4d {
    const Eigen::Vector2d normal =
        bicubic ? bicubic_vertex(surface_, kBicubicParts * i + a, kBicubicParts * j + b)
                : surface_.texel(i + a, j + b);
    return {corner.x() + static_cast<double>(a) / parts, corner.y() + static_cast<double>(b) / parts,
            normal.x(), normal.y()};
  };
  for (int b = 0; b < parts; ++b) {
    for (int a = 0; a < parts; ++a) {
      const Eigen::Vector4d right = vertex(a + 1, b), top = vertex(a, b + 1);
      add_triangle(vertex(a, b), right, top);
      add_triangle(vertex(a + 1, b + 1), top, right);
    }
  }
}

void BlockMoments::add_square(const Eigen::Vector2d& corner, const Eigen::Vector2d& normal) {
  const Eigen::Vector4d mean(corner.x() + 0.5, corner.y() + 0.5, normal.x(), normal.y());
  const Eigen::Vector4d variances(1.0 / 12, 1.0 / 12, 0, 0);
  at(cells_.cell_of(normal.x(), normal.y())).add(1, mean, variances.asDiagonal());
}

void BlockMoments::add_piece(const Eigen::Vector4d& a, const Eigen::Vector4d& b, const Eigen::Vector4d& c) {
  const Eigen::Vector4d ab = b - a, ac = c - a, mean = (a + b + c) / 3;
  const double weight = 0.5 * std::abs(ab.x() * ac.y() - ab.y() * ac.x());
  at(cells_.cell_of(mean[2], mean[3])).add_weighted(weight, mean, weight / 18.0 * edge_products(ab, ac));
}

void BlockMoments::add_strips(const Eigen::Vector4d& apex, const Eigen::Vector4d& b, const Eigen::Vector4d& c,
                              int strips, int cuts) {
  const Eigen::Vector4d to_b = (b - apex) / strips, along = (c - b) / strips;
  for (int strip = 0; strip < strips; ++strip) {
    // A strip's sides are `strip` and `strip + 1` times `along`, and it has as many cuts as its part of the
    // side.
    const int count = (cuts * (strip + 1) + strips - 1) / strips;
    const Eigen::Vector4d near = apex + strip * to_b, far = near + to_b;
    const Eigen::Vector4d near_step = strip * along / count, far_step = (strip + 1) * along / count;
    for (int cut = 0; cut < count; ++cut) {
      const Eigen::Vector4d near_left = near + cut * near_step, far_left = far + cut * far_step;
      add_piece(near_left, far_left, far_left + far_step);
      if (strip > 0) add_piece(near_left, far_left + far_step, near_left + near_step);
    }
  }
}

/// A uniform triangle's covariance is a twelfth of its corners' products about their mean; n^2 pieces alike
/// have an n^2th of it each.
void BlockMoments::add_triangle(const Eigen::Vector4d& a, const Eigen::Vector4d& b,
                                const Eigen::Vector4d& c) {
  const Eigen::Vector4d ab = b - a, ac = c - a;
  const auto pieces = [&](const Eigen::Vector4d& edge) {
    return edge.tail<2>().cwiseAbs().maxCoeff() / (kPieceCells * cells_.width());
  };
  const double pieces_ab = pieces(ab), pieces_ac = pieces(ac), pieces_bc = pieces(ac - ab);
  const double least = std::min({pieces_ab, pieces_ac, pieces_bc}),
               most = std::ceil(std::max({pieces_ab, pieces_ac, pieces_bc}));
  if (most > kMostCuts || (least <= 1 && most > 2)) {
    const int strips = static_cast<int>(std::min<double>(most, kMostStrips)),
              cuts = static_cast<int>(std::clamp<double>(std::ceil(least), 1, kMostCuts));
    if (least == pieces_ab) return add_strips(c, a, b, strips, cuts);
    if (least == pieces_ac) return add_strips(b, a, c, strips, cuts);
    return add_strips(a, b, c, strips, cuts);
  }
  const int n = static_cast<int>(std::max(most, 1.0));
  const double area = 0.5 * std::abs(ab.x() * ac.y() - ab.y() * ac.x());
  const double weight = area / (n * n);
  const Eigen::Matrix4d weighted_covariance = weight / (18.0 * n * n) * edge_products(ab, ac);
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column + row < n; ++column) {
      const auto add = [&](double third) {  // of a piece's edges from the corner to the piece's mean
        const Eigen::Vector4d mean = a + (column + third) / n * ab + (row + third) / n * ac;
        at(cells_.cell_of(mean[2], mean[3])).add_weighted(weight, mean, weighted_covariance);
      };
      add(1.0 / 3);
      if (column + row + 1 < n) add(2.0 / 3);
    }
  }
}

Moments& BlockMoments::at(int cell) {
  int& place = place_of_cell_[cell];
  if (place < 0) {
    place = static_cast<int>(sums_.size());
    sums_.push_back({cell, {}});
  }
  return sums_[place].moments;
}

std::vector<CellMoments> BlockMoments::take() {
  order_.clear();
  for (std::size_t n = 0; n < sums_.size(); ++n) order_.emplace_back(sums_[n].cell, static_cast<int>(n));
  std::sort(order_.begin(), order_.end());
  std::vector<CellMoments> taken;
  taken.reserve(order_.size());
  for (const auto& [cell, place] : order_) {
    taken.push_back(sums_[place]);
    place_of_cell_[cell] = -1;
  }
  sums_.clear();
  return taken;
}

std::vector<CellMoments> without_light_cells(const NormalCells& cells, std::vector<CellMoments> parts) {
  double weight = 0;
  for (const CellMoments& part : parts) weight += part.moments.weight;
  const double light = kLight * weight / static_cast<double>(parts.size());
  for (CellMoments& part : parts) {
    if (part.moments.weight > light || !(part.moments.weight > 0)) continue;
    CellMoments* const neighbour = nearest_neighbour(cells, part, &parts);
    if (neighbour == nullptr) continue;
    neighbour->moments.add(part.moments);
    part.moments = {};
  }
  parts.erase(std::remove_if(parts.begin(), parts.end(),
                             [](const CellMoments& part) { return !(part.moments.weight > 0); }),
              parts.end());
  return parts;
}

}  // namespace mica::host
