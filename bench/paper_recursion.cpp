#include "bench/paper_recursion.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "bench/paper_triangle.h"
#include "mica/error.h"

namespace mica::host::bench {
namespace {

constexpr float kCutoff = 5;  ///< standard deviations, [Yan14] sec. 6

void include(PaperRecursion::Box* box, const PaperRecursion::Box& other) {
  box->low = {std::min(box->low.s, other.low.s), std::min(box->low.t, other.low.t)};
  box->high = {std::max(box->high.s, other.high.s), std::max(box->high.t, other.high.t)};
}

/// Interleaves the bits of two indices below 2^16.
std::uint32_t morton(std::uint32_t i, std::uint32_t j) {
  const auto spread = [](std::uint32_t x) {
    x = (x | x << 8) & 0x00ff00ffu;
    x = (x | x << 4) & 0x0f0f0f0fu;
    x = (x | x << 2) & 0x33333333u;
    return (x | x << 1) & 0x55555555u;
  };
  return spread(i) | spread(j) << 1;
}

}  // namespace

PaperRecursion::PaperRecursion(const Surface& surface) : width_(surface.width()), height_(surface.height()) {
  if (surface.interpolation() != Interpolation::bilinear) {
    throw UsageError("the paper's recursion is implemented for bilinear surfaces only");
  }
  normals_.reserve(static_cast<std::size_t>(width_ + 1) * (height_ + 1));
  for (int j = 0; j <= height_; ++j) {
    for (int i = 0; i <= width_; ++i) {
      const Eigen::Vector2f normal = surface.texel(i, j).cast<float>();
      normals_.push_back({normal.x(), normal.y()});
    }
  }
  int side = 1;
  while (side < std::max(width_, height_)) side *= 2;
  levels_.emplace_back(static_cast<std::size_t>(side) * side);
  for (int j = 0; j < height_; ++j) {
    for (int i = 0; i < width_; ++i) {
      for (const int k : {0, 1, width_ + 1, width_ + 2}) {
        const Normal& normal = normals_[static_cast<std::size_t>(j) * (width_ + 1) + i + k];
        include(&levels_[0][morton(i, j)], {normal, normal});
      }
    }
  }
  while (levels_.back().size() > 1) {
    const std::vector<Box>& below = levels_.back();
    std::vector<Box> level(below.size() / 4);
    for (std::size_t k = 0; k < below.size(); ++k) include(&level[k / 4], below[k]);
    levels_.push_back(std::move(level));
  }
}

/// One query on its way through the quadtree. Positions are texels relative to the texel centre (0, 0) of a
/// period.
class Traversal {
 public:
  Traversal(const PaperRecursion& recursion, const Query& query) : recursion_(recursion) {
    const double width = recursion.width_, height = recursion.height_;
    const Eigen::Vector2d& uv = query.footprint.mean_uv;
    const Eigen::Matrix2d& cov = query.footprint.cov_uv;
    mean_x_ = (uv.x() - std::floor(uv.x())) * width - 0.5;
    mean_y_ = (uv.y() - std::floor(uv.y())) * height - 0.5;
    cov_xx_ = cov(0, 0) * width * width;
    cov_xy_ = cov(0, 1) * width * height;
    cov_yy_ = cov(1, 1) * height * height;
    const double determinant = cov_xx_ * cov_yy_ - cov_xy_ * cov_xy_;
    precision_xx_ = cov_yy_ / determinant;
    precision_xy_ = -cov_xy_ / determinant;
    precision_yy_ = cov_xx_ / determinant;
    s_ = static_cast<float>(query.half_vector.x());
    t_ = static_cast<float>(query.half_vector.y());
    precision_r_ = 1 / (query.roughness * query.roughness);
    reach_r_squared_ = static_cast<float>(kCutoff * kCutoff / precision_r_);
    constexpr double two_pi = 6.28318530717958647692;
    scale_ = precision_r_ / (two_pi * two_pi * std::sqrt(determinant));
  }

  double run() {
    const double reach_x = kCutoff * std::sqrt(cov_xx_), reach_y = kCutoff * std::sqrt(cov_yy_);
    const int width = recursion_.width_, height = recursion_.height_;
    const int first_x = static_cast<int>(std::floor((mean_x_ - reach_x) / width));
    const int last_x = static_cast<int>(std::floor((mean_x_ + reach_x) / width));
    const int first_y = static_cast<int>(std::floor((mean_y_ - reach_y) / height));
    const int last_y = static_cast<int>(std::floor((mean_y_ + reach_y) / height));
    for (int y = first_y; y <= last_y; ++y) {
      for (int x = first_x; x <= last_x; ++x) visit_period(x, y, reach_x, reach_y);
    }
    return std::max(0.0, scale_ * sum_);
  }

 private:
  /// Enters a period at the level where the footprint's box is about as large as a node.
  void visit_period(int x, int y, double reach_x, double reach_y) {
    center_x_ = mean_x_ - static_cast<double>(x) * recursion_.width_;
    center_y_ = mean_y_ - static_cast<double>(y) * recursion_.height_;
    prepare_whitening();
    int level = 0;
    const int top = static_cast<int>(recursion_.levels_.size()) - 1;
    while (level < top && (1 << level) < 2 * std::max(reach_x, reach_y)) ++level;
    const auto node = [level](double texel, int texels) {
      return static_cast<int>(std::clamp(std::floor(texel), 0.0, texels - 1.0)) >> level;
    };
    const int last_j = node(center_y_ + reach_y, recursion_.height_),
              last_i = node(center_x_ + reach_x, recursion_.width_);
    for (int j = node(center_y_ - reach_y, recursion_.height_); j <= last_j; ++j) {
      for (int i = node(center_x_ - reach_x, recursion_.width_); i <= last_i; ++i) {
        visit(level, morton(i, j), i, j);
      }
    }
  }

  void prepare_whitening() {
    const double sigma_x = std::sqrt(cov_xx_), lean = cov_xy_ / sigma_x;
    const double sigma_y = std::sqrt(cov_yy_ - lean * lean);
    whiten_x_ = static_cast<float>(1 / sigma_x);
    whiten_y_ = static_cast<float>(1 / sigma_y);
    shear_ = static_cast<float>(-lean / (sigma_x * sigma_y));
    half_diagonal_ = 0.5f * (std::hypot(whiten_x_, shear_) + whiten_y_);
    origin_x_ = static_cast<float>(center_x_);
    origin_y_ = static_cast<float>(center_y_);
  }

  void visit(int level, std::uint32_t index, int i, int j) {
    if (misses(recursion_.levels_[level][index], level, i, j)) return;
    if (level == 0) return integrate_texel(i, j);
    const std::uint32_t child = 4 * index;
    visit(level - 1, child, 2 * i, 2 * j);
    visit(level - 1, child + 1, 2 * i + 1, 2 * j);
    visit(level - 1, child + 2, 2 * i, 2 * j + 1);
    visit(level - 1, child + 3, 2 * i + 1, 2 * j + 1);
  }

  bool misses(const PaperRecursion::Box& box, int level, int i, int j) const {
    const float ds = std::max(std::max(box.low.s - s_, s_ - box.high.s), 0.0f);
    const float dt = std::max(std::max(box.low.t - t_, t_ - box.high.t), 0.0f);
    if (ds * ds + dt * dt > reach_r_squared_) return true;
    // Whitened distance of the node's centre against that of its half diagonal.
    const float side = static_cast<float>(1 << level);
    const float x = (static_cast<float>(i) + 0.5f) * side - origin_x_,
                y = (static_cast<float>(j) + 0.5f) * side - origin_y_;
    const float a = whiten_x_ * x, b = shear_ * x + whiten_y_ * y, reach = kCutoff + half_diagonal_ * side;
    return a * a + b * b > reach * reach;
  }

  void integrate_texel(int i, int j) {
    const int pitch = recursion_.width_ + 1;
    const PaperRecursion::Normal* n = &recursion_.normals_[static_cast<std::size_t>(j) * pitch + i];
    const double x = i - center_x_, y = j - center_y_;
    sum_ += integrate_triangle(n[0], n[1], n[pitch], x, y, 1);
    sum_ += integrate_triangle(n[pitch + 1], n[pitch], n[1], x + 1, y + 1, -1);
  }

  /// The right triangle at (x, y) with legs towards (x + direction, y) and (x, y + direction).
  double integrate_triangle(const PaperRecursion::Normal& corner, const PaperRecursion::Normal& along_x,
                            const PaperRecursion::Normal& along_y, double x, double y,
                            double direction) const {
    const double s = corner.s - s_, t = corner.t - t_;
    const double su = along_x.s - corner.s, tu = along_x.t - corner.t, sv = along_y.s - corner.s,
                 tv = along_y.t - corner.t;
    const double px = precision_xx_ * x + precision_xy_ * y, py = precision_xy_ * x + precision_yy_ * y;
    return integrate_paper_triangle({precision_xx_ + precision_r_ * (su * su + tu * tu),
                                     precision_xy_ + precision_r_ * (su * sv + tu * tv),
                                     precision_yy_ + precision_r_ * (sv * sv + tv * tv),
                                     direction * px + precision_r_ * (s * su + t * tu),
                                     direction * py + precision_r_ * (s * sv + t * tv),
                                     px * x + py * y + precision_r_ * (s * s + t * t)});
  }

  const PaperRecursion& recursion_;
  double mean_x_, mean_y_, center_x_ = 0, center_y_ = 0;
  double cov_xx_, cov_xy_, cov_yy_, precision_xx_, precision_xy_, precision_yy_, precision_r_, scale_;
  float s_, t_, reach_r_squared_;
  float whiten_x_, whiten_y_, shear_, half_diagonal_, origin_x_, origin_y_;
  double sum_ = 0;
};

std::vector<float> PaperRecursion::evaluate(const std::vector<Query>& queries) const {
  std::vector<float> densities(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t k) {
    densities[k] = static_cast<float>(Traversal(*this, queries[k]).run());
  });
  return densities;
}

}  // namespace mica::host::bench
