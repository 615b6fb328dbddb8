#include "host/reference/beckmann_mixture.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "host/base/symmetric_matrix.h"

namespace mica::host::reference {
namespace {

constexpr double kReach = 8;     // standard deviations
constexpr int kKernelCells = 3;  // on either side of an element's own: 8 standard deviations of its kernel

double kernel_variance() {
  return 1 / (8 * std::log(2.0));
}

/// A point under an element's position kernel along an axis: offset from the centre in spacings.
struct Point {
  double offset, weight;
};

/// Gauss-Legendre points of the cells under the kernel, in ascending order.
const std::vector<Point>& kernel_points() {
  static const std::vector<Point> points = [] {
    using Rule = boost::math::quadrature::gauss<double, 6>;
    std::vector<Point> all;
    for (int cell = -kKernelCells; cell <= kKernelCells; ++cell) {
      for (std::size_t n = 0; n < Rule::abscissa().size(); ++n) {
        for (const double sign : {-1.0, 1.0}) {
          const double offset = cell + 0.5 * sign * Rule::abscissa()[n];
          all.push_back({offset, Rule::weights()[n] * std::exp(-0.5 * offset * offset / kernel_variance())});
        }
      }
    }
    std::sort(all.begin(), all.end(), [](const Point& a, const Point& b) { return a.offset < b.offset; });
    return all;
  }();
  return points;
}

long wrap(long index, long period) {
  return (index % period + period) % period;
}

Eigen::Vector2d slope_of(const Eigen::Vector2d& normal) {
  return -normal / std::sqrt(1 - normal.squaredNorm());
}

/// Derivative of the slope by the normal on the disk, at a slope.
Eigen::Matrix2d slope_jacobian(const Eigen::Vector2d& slope) {
  const double w = 1 + slope.squaredNorm();
  return -std::sqrt(w) * (Eigen::Matrix2d::Identity() + slope * slope.transpose());
}

/// Where a point lies on the map along an axis: between the texels `cell` and `cell` + 1.
struct Sample {
  long cell;
  double fraction, weight;
};

/// The points under the kernel of element `index`. @param spacing of elements, in texels.
std::vector<Sample> samples_of(long index, double spacing) {
  std::vector<Sample> samples;
  for (const Point& point : kernel_points()) {
    const double x = (static_cast<double>(index) + 0.5 + point.offset) * spacing, cell = std::floor(x);
    samples.push_back({std::lround(cell), x - cell, point.weight});
  }
  return samples;
}

/// The lobe of element (a, b), without roughness.
SlopeLobe fit(const Surface& surface, int elements, long a, long b) {
  SlopeLobe lobe;
  if (surface.interpolation() == Interpolation::nearest) {
    lobe.mean = slope_of(surface.texel(a / elements, b / elements));
    return lobe;
  }
  const std::vector<Sample> across = samples_of(a, 1.0 / elements);
  std::vector<Eigen::Vector2d> row(across.back().cell - across.front().cell + 2);  // the map at a point's v
  double weights = 0, m1 = 0, m2 = 0, m11 = 0, m12 = 0, m22 = 0;  // sums of products of the slope's parts
  for (const Sample& v : samples_of(b, 1.0 / elements)) {
    for (std::size_t n = 0; n < row.size(); ++n) {
      const long i = across.front().cell + static_cast<long>(n);
      row[n] = (1 - v.fraction) * surface.texel(i, v.cell) + v.fraction * surface.texel(i, v.cell + 1);
    }
    for (const Sample& u : across) {
      const Eigen::Vector2d* pair = &row[u.cell - across.front().cell];
      const Eigen::Vector2d slope = slope_of((1 - u.fraction) * pair[0] + u.fraction * pair[1]);
      const double weight = u.weight * v.weight, p = slope.x(), q = slope.y();
      weights += weight, m1 += weight * p, m2 += weight * q;
      m11 += weight * p * p, m12 += weight * p * q, m22 += weight * q * q;
    }
  }
  lobe.mean = Eigen::Vector2d(m1, m2) / weights;
  lobe.covariance << m11, m12, m12, m22;
  lobe.covariance = (lobe.covariance / weights - lobe.mean * lobe.mean.transpose()).eval();
  return lobe;
}

}  // namespace

BeckmannMixture::BeckmannMixture(const Surface& surface, int elements)
    : width_(static_cast<long>(surface.width()) * elements),
      height_(static_cast<long>(surface.height()) * elements),
      corner_(surface.interpolation() == Interpolation::nearest ? 0 : 0.5 * elements),
      fitted_(width_ * height_) {
  tbb::parallel_for(0L, height_, [&](long b) {
    for (long a = 0; a < width_; ++a) fitted_[b * width_ + a] = fit(surface, elements, a, b);
  });
}

std::vector<SlopeLobe> BeckmannMixture::lobes(const Footprint& footprint, double roughness) const {
  const double k = kernel_variance();
  const Eigen::DiagonalMatrix<double, 2> spacings(static_cast<double>(width_), static_cast<double>(height_));
  const PrincipalAxes axes = principal_axes(spacings * footprint.cov_uv * spacings);
  const Eigen::Vector2d variances = (axes.eigenvalues.array() - k).max(k);
  const Eigen::Matrix2d cov = axes.eigenvectors * variances.asDiagonal() * axes.eigenvectors.transpose();
  const Eigen::Matrix2d inverse = cov.inverse();
  const Eigen::Vector2d mean = spacings * footprint.mean_uv - Eigen::Vector2d(corner_, corner_),
                        extent = kReach * cov.diagonal().cwiseSqrt();
  struct Place {
    long a, b;
    double weight;
  };
  std::vector<Place> places;
  double sum = 0;
  for (long b = std::lround(std::floor(mean.y() - extent.y()));
       b <= std::lround(std::ceil(mean.y() + extent.y())); ++b) {
    for (long a = std::lround(std::floor(mean.x() - extent.x()));
         a <= std::lround(std::ceil(mean.x() + extent.x())); ++a) {
      const Eigen::Vector2d offset =
          Eigen::Vector2d(static_cast<double>(a) + 0.5, static_cast<double>(b) + 0.5) - mean;
      const double weight = std::exp(-0.5 * offset.dot(inverse * offset));
      sum += weight;
      if (weight > 1e-12) places.push_back({a, b, weight});
    }
  }
  std::vector<SlopeLobe> lobes(places.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t n) {
    lobes[n] = fitted_[wrap(places[n].b, height_) * width_ + wrap(places[n].a, width_)];
    const Eigen::Matrix2d B = slope_jacobian(lobes[n].mean);
    lobes[n].covariance += roughness * roughness * B * B.transpose();
    lobes[n].weight = places[n].weight / sum;
  });
  return lobes;
}

double BeckmannMixture::density(const std::vector<SlopeLobe>& lobes, const Eigen::Vector2d& half_vector) {
  const double squared_cosine = 1 - half_vector.squaredNorm();
  if (squared_cosine <= 0) return 0;
  const Eigen::Vector2d slope = slope_of(half_vector);
  double sum = 0;
  for (const SlopeLobe& lobe : lobes) {
    const Eigen::Vector2d offset = slope - lobe.mean;
    sum += lobe.weight * std::exp(-0.5 * offset.dot(lobe.covariance.inverse() * offset)) /
           (2 * M_PI * std::sqrt(lobe.covariance.determinant()));
  }
  return sum / (squared_cosine * squared_cosine);
}

double BeckmannMixture::visible_area(const std::vector<SlopeLobe>& lobes, const Eigen::Vector3d& direction) {
  // <o, w> / (w.g) is o_z - m.o_xy of slope m where that is positive: the mean of a Gaussian's positive part.
  const Eigen::Vector2d across = direction.head<2>();
  double sum = 0;
  for (const SlopeLobe& lobe : lobes) {
    const double mean = direction.z() - lobe.mean.dot(across);
    const double sigma = std::sqrt(across.dot(lobe.covariance * across));
    if (!(sigma > 0)) {
      sum += lobe.weight * std::max(mean, 0.0);
      continue;
    }
    const double z = mean / sigma;
    sum += lobe.weight * (mean * 0.5 * std::erfc(-z / std::sqrt(2.0)) +
                          sigma * std::exp(-0.5 * z * z) / std::sqrt(2 * M_PI));
  }
  return sum;
}

double BeckmannMixture::projected_area(const std::vector<SlopeLobe>& lobes,
                                       const Eigen::Vector3d& direction) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const SlopeLobe& lobe : lobes) mean += lobe.weight * lobe.mean;
  return std::max(direction.z() - mean.dot(direction.head<2>()), 0.0);
}

double BeckmannMixture::scattering(const std::vector<SlopeLobe>& lobes, const Eigen::Vector3d& view,
                                   const Eigen::Vector3d& light) {
  const Eigen::Vector3d half = (view + light).normalized();
  const double G1_light = projected_area(lobes, light) / visible_area(lobes, light);
  // G1(o) / A_P(o) is one over the visible area, also where the patch turns away from the view.
  return G1_light * density(lobes, half.head<2>()) / (4 * visible_area(lobes, view));
}

}  // namespace mica::host::reference
