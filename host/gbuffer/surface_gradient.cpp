#include "host/gbuffer/surface_gradient.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/scene/pixel_fit.h"

namespace mica::host {
namespace {

// Places of FitStencil::centers().
constexpr std::size_t kUp = 2, kLeft = 4, kRight = 5, kDown = 7;
struct Corner {
  std::size_t place, across, along;  ///< a neighbour at a corner, and those at the sides beside it
};
constexpr Corner kCorners[] = {{1, kUp, kLeft}, {3, kUp, kRight}, {6, kDown, kLeft}, {8, kDown, kRight}};

/// One smooth surface: its normals hardly turn, and the step lies in its plane. Over a smooth surface the
/// step's product with the sum of both normals vanishes to the third order; between a near object and a far
/// one it does not.
bool is_same_surface(const BufferPixel& a, const BufferPixel& b) {
  constexpr double least_cosine = 0.5, most_sine = 0.4;
  if (a.material != b.material || a.material == BufferPixel::kNothing) return false;
  if (!(a.normal.dot(b.normal) > least_cosine)) return false;
  const Eigen::Vector3d step = (b.position - a.position).cast<double>();
  const Eigen::Vector3d normals = (a.face_normal + b.face_normal).cast<double>();
  return std::abs(step.dot(normals)) <= most_sine * step.norm() * normals.norm();
}

/// uv along both sides of a pixel differ by more than surfaces bend: between islands of uv lies a seam, and
/// the smaller change is that of the surface.
void cut_seam(const BufferPixel& middle, const BufferPixel& before, const BufferPixel& after,
              bool* is_near_before, bool* is_near_after) {
  constexpr double most_change = 0.5;
  if (!*is_near_before || !*is_near_after) return;
  const auto rate = [&](const BufferPixel& other) -> Eigen::Vector2d {
    const double length = (other.position - middle.position).cast<double>().norm();
    return length > 0 ? Eigen::Vector2d(uv_step(middle, other) / length) : Eigen::Vector2d(0, 0);
  };
  const Eigen::Vector2d backwards = -rate(before), forwards = rate(after);
  const double larger = std::max(backwards.norm(), forwards.norm());
  if ((forwards - backwards).norm() <= most_change * larger) return;
  *(backwards.norm() > forwards.norm() ? is_near_before : is_near_after) = false;
}

}  // namespace

bool SurfaceGradient::has_all() const {
  return std::all_of(is_near.begin(), is_near.end(), [](bool near) { return near; });
}

Eigen::Vector2d uv_step(const BufferPixel& from, const BufferPixel& to) {
  const Eigen::Vector2d step = (to.uv.cast<double>() - from.uv.cast<double>());
  return step - step.array().round().matrix();
}

void PlaneGradient::add(const Eigen::Vector2d& place, const Eigen::Vector2d& step, double squared_pixels) {
  const double weight = std::exp(-2 * squared_pixels);  // as FitStencil's
  moments_ += weight * place * place.transpose();
  products_ += weight * step * place.transpose();
}

bool PlaneGradient::is_known() const {
  return moments_.determinant() > 1e-12 * moments_.squaredNorm();
}

Eigen::Matrix2d PlaneGradient::value() const {
  if (is_known()) return products_ * moments_.inverse();
  const double trace = moments_.trace();  // the pseudoinverse of a matrix of rank 1
  return trace > 0 ? Eigen::Matrix2d(products_ * moments_ / (trace * trace)) : Eigen::Matrix2d::Zero();
}

SurfaceGradient surface_gradient(const Rectangle<BufferPixel>& pixels, int row, int column) {
  const std::vector<Eigen::Vector2d>& offsets = FitStencil::centers().offsets();
  const BufferPixel& middle = pixels.at(row, column);
  const auto neighbour = [&](std::size_t place) -> const BufferPixel& {
    return pixels.at(row + static_cast<int>(offsets[place].y()),
                     column + static_cast<int>(offsets[place].x()));
  };
  SurfaceGradient gradient;
  for (std::size_t place = 0; place < offsets.size(); ++place)
    gradient.is_near[place] = place == 0 || is_same_surface(middle, neighbour(place));
  cut_seam(middle, neighbour(kLeft), neighbour(kRight), &gradient.is_near[kLeft], &gradient.is_near[kRight]);
  cut_seam(middle, neighbour(kUp), neighbour(kDown), &gradient.is_near[kUp], &gradient.is_near[kDown]);
  for (const Corner& corner : kCorners)
    gradient.is_near[corner.place] =
        gradient.is_near[corner.place] && gradient.is_near[corner.across] && gradient.is_near[corner.along];
  const bool has_both_axes = (gradient.is_near[kLeft] || gradient.is_near[kRight]) &&
                             (gradient.is_near[kUp] || gradient.is_near[kDown]);
  gradient.x = middle.face_normal.cast<double>().unitOrthogonal();
  gradient.y = middle.face_normal.cast<double>().cross(gradient.x);
  if (!gradient.has_all() && !middle.dpduv.isZero(0)) {
    Eigen::Matrix2d step;
    step << gradient.on_plane(middle.dpduv.col(0).cast<double>()),
        gradient.on_plane(middle.dpduv.col(1).cast<double>());
    if (step.determinant() != 0) {
      gradient.duv = step.inverse();
      gradient.is_known = true;
      return gradient;
    }
  }
  if (!has_both_axes) return gradient;
  PlaneGradient duv;
  for (std::size_t place = 1; place < offsets.size(); ++place) {
    if (!gradient.is_near[place]) continue;
    const BufferPixel& other = neighbour(place);
    duv.add(gradient.on_plane((other.position - middle.position).cast<double>()), uv_step(middle, other),
            offsets[place].squaredNorm());
  }
  gradient.duv = duv.value();
  gradient.is_known = duv.is_known() && gradient.duv.determinant() != 0;
  return gradient;
}

Hit hit_of(const BufferPixel& pixel, const SurfaceGradient& gradient) {
  Hit hit;
  hit.position = pixel.position.cast<double>();
  hit.normal = pixel.normal.cast<double>(), hit.face_normal = pixel.face_normal.cast<double>();
  hit.uv = pixel.uv.cast<double>();
  hit.dpdu = hit.dpdv = Eigen::Vector3d::Zero();
  if (gradient.is_known) {
    const Eigen::Matrix2d inverse = gradient.duv.inverse();
    hit.dpdu = inverse(0, 0) * gradient.x + inverse(1, 0) * gradient.y;
    hit.dpdv = inverse(0, 1) * gradient.x + inverse(1, 1) * gradient.y;
  }
  hit.tangent = pixel.tangent.isZero(0) ? hit.dpdu : Eigen::Vector3d(pixel.tangent.cast<double>());
  return hit;
}

}  // namespace mica::host
