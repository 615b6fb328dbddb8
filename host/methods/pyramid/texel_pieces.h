#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "host/surface/interpolate.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Cuts texels into pieces over which normals hardly change.
/// @tparam Take is given each: `take(weight, mean, weighted_covariance)`, in texels^2 and (x, y, s, t); the
/// covariance only if Take::kTakesCovariance.
template <typename Take>
class TexelPieces {
 public:
  /// @param cell_width of the normal disk: what normals may change by. Both have to outlive this.
  TexelPieces(const Surface& surface, double cell_width, Take* take)
      : surface_(surface), cell_width_(cell_width), take_(*take) {}

  void cut(long i, long j);

 private:
  /// Normals may change by this much, in cells, over a piece of a triangle.
  static constexpr double kPieceCells = 1.0;
  /// A triangle is cut into at most the square of this many pieces alike. Where normals change faster, or
  /// hardly along one side, as beside an edge or a scratch, it is cut into strips along that side, and these
  /// into pieces.
  static constexpr int kMostCuts = 8;
  static constexpr int kMostStrips = 32;

  static constexpr int kBicubicParts = 4;  // a texel and axis
  /// 18 times the covariance of a uniform triangle with these two edges.
  static Eigen::Matrix4d edge_products(const Eigen::Vector4d& ab, const Eigen::Vector4d& ac) {
    return ab * ab.transpose() + ac * ac.transpose() - 0.5 * (ab * ac.transpose() + ac * ab.transpose());
  }
  Eigen::Matrix4d weighted(double weight, const Eigen::Vector4d& ab, const Eigen::Vector4d& ac) const {
    if constexpr (Take::kTakesCovariance) return weight * edge_products(ab, ac);
    return Eigen::Matrix4d::Zero();
  }

  void add_triangle(const Eigen::Vector4d& a, const Eigen::Vector4d& b, const Eigen::Vector4d& c);
  /// One of its pieces, with one normal for all of it.
  void add_piece(const Eigen::Vector4d& a, const Eigen::Vector4d& b, const Eigen::Vector4d& c);
  /// A triangle in strips along the side from b to c, and these in up to so many cuts.
  void add_strips(const Eigen::Vector4d& apex, const Eigen::Vector4d& b, const Eigen::Vector4d& c, int strips,
                  int cuts);
  void add_square(const Eigen::Vector2d& corner, const Eigen::Vector2d& normal);

  const Surface& surface_;
  double cell_width_;
  Take& take_;
};

template <typename Take>
void TexelPieces<Take>::cut(long i, long j) {
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

template <typename Take>
void TexelPieces<Take>::add_square(const Eigen::Vector2d& corner, const Eigen::Vector2d& normal) {
  const Eigen::Vector4d mean(corner.x() + 0.5, corner.y() + 0.5, normal.x(), normal.y());
  const Eigen::Vector4d variances(1.0 / 12, 1.0 / 12, 0, 0);
  take_(1.0, mean, Eigen::Matrix4d(variances.asDiagonal()));
}

template <typename Take>
void TexelPieces<Take>::add_piece(const Eigen::Vector4d& a, const Eigen::Vector4d& b,
                                  const Eigen::Vector4d& c) {
  const Eigen::Vector4d ab = b - a, ac = c - a, mean = (a + b + c) / 3;
  const double weight = 0.5 * std::abs(ab.x() * ac.y() - ab.y() * ac.x());
  take_(weight, mean, weighted(weight / 18.0, ab, ac));
}

template <typename Take>
void TexelPieces<Take>::add_strips(const Eigen::Vector4d& apex, const Eigen::Vector4d& b,
                                   const Eigen::Vector4d& c, int strips, int cuts) {
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
template <typename Take>
void TexelPieces<Take>::add_triangle(const Eigen::Vector4d& a, const Eigen::Vector4d& b,
                                     const Eigen::Vector4d& c) {
  const Eigen::Vector4d ab = b - a, ac = c - a;
  const auto pieces = [&](const Eigen::Vector4d& edge) {
    return edge.tail<2>().cwiseAbs().maxCoeff() / (kPieceCells * cell_width_);
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
  const Eigen::Matrix4d weighted_covariance = weighted(weight / (18.0 * n * n), ab, ac);
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column + row < n; ++column) {
      const auto add = [&](double third) {  // of a piece's edges from the corner to the piece's mean
        const Eigen::Vector4d mean = a + (column + third) / n * ab + (row + third) / n * ac;
        take_(weight, mean, weighted_covariance);
      };
      add(1.0 / 3);
      if (column + row + 1 < n) add(2.0 / 3);
    }
  }
}

}  // namespace mica::host
