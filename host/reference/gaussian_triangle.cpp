#include "host/reference/gaussian_triangle.h"

// Owen's T needs no long double inside to be good to 1e-16.
#define BOOST_MATH_PROMOTE_DOUBLE_POLICY false
#include <boost/math/special_functions/owens_t.hpp>
#include <cmath>

namespace mica::host::reference {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;
constexpr double kSquareRootOf2 = 1.41421356237309504880;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Owen's T(h, x / h), h > 0: as a function of the place x on a line at distance h.
double owens_t_on_line(double h, double x) {
  constexpr double vanished = 8.6;  // the Gaussian's tail beyond is below 1e-17
  if (h > vanished) return 0;
  if (std::abs(x) > vanished) return std::copysign(0.25 * std::erfc(h / kSquareRootOf2), x);
  return boost::math::owens_t(h, x / h);
}

/// Signed probability of the triangle between the origin and one edge.
double edge_probability(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d direction = (to - from).normalized();
  const double signed_distance = cross(from, direction);
  const double h = std::abs(signed_distance);
  if (h == 0) return 0;  // also an edge of no length
  const double x0 = from.dot(direction), x1 = to.dot(direction);
  const double angle = (std::atan2(x1, h) - std::atan2(x0, h)) / kTwoPi;
  return std::copysign(angle - (owens_t_on_line(h, x1) - owens_t_on_line(h, x0)), signed_distance);
}

double segment_nearest_squared(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d edge = to - from;
  const double length_squared = edge.squaredNorm();
  const double t = length_squared > 0 ? std::clamp(-from.dot(edge) / length_squared, 0.0, 1.0) : 0.0;
  return (from + t * edge).squaredNorm();
}

/// Index of the vertex opposite to the longest edge.
int opposite_of_longest(const std::array<Whitened, 3>& v) {
  const double edges[3] = {(v[2] - v[1]).squaredNorm(), (v[0] - v[2]).squaredNorm(),
                           (v[1] - v[0]).squaredNorm()};
  return static_cast<int>(std::max_element(edges, edges + 3) - edges);
}

}  // namespace

double PlanarTriangle::area() const {
  return 0.5 * diameter() * (vertices[2].y() - vertices[0].y());
}

double PlanarTriangle::nearest_squared() const {
  return offset_squared + reference::nearest_squared(vertices.data(), 3);
}

// Gram-Schmidt on two edges, the second one twice, as slivers need; never through the inner products of the
// edges, which would lose half the digits. Rounding errors of the second axis move the plane's offset and the
// triangle in it together, and cancel in |w|^2.
PlanarTriangle flatten(const std::array<Whitened, 3>& v) {
  PlanarTriangle planar;
  const int apex = opposite_of_longest(v);
  planar.order = {(apex + 1) % 3, (apex + 2) % 3, apex};
  const Whitened& base = v[planar.order[0]];
  const Whitened long_edge = v[planar.order[1]] - base, short_edge = v[apex] - base;
  const double length = long_edge.norm();
  const Whitened x_axis = length > 0 ? Whitened(long_edge / length) : Whitened::Zero();

  double along = x_axis.dot(short_edge);
  Whitened rest = short_edge - along * x_axis;
  const double correction = x_axis.dot(rest);
  along += correction;
  rest -= correction * x_axis;
  const double height = rest.norm();
  const Whitened y_axis = height > 0 ? Whitened(rest / height) : Whitened::Zero();

  const Eigen::Vector2d origin(x_axis.dot(base), y_axis.dot(base));
  planar.vertices = {origin, origin + Eigen::Vector2d(length, 0), origin + Eigen::Vector2d(along, height)};
  planar.offset_squared = (base - origin.x() * x_axis - origin.y() * y_axis).squaredNorm();
  return planar;
}

double nearest_squared(const Eigen::Vector2d* vertices, int count) {
  double nearest = segment_nearest_squared(vertices[count - 1], vertices[0]);
  double turn = cross(vertices[count - 1], vertices[0]);
  bool inside = turn != 0;
  for (int k = 0; k + 1 < count; ++k) {
    nearest = std::min(nearest, segment_nearest_squared(vertices[k], vertices[k + 1]));
    inside = inside && turn * cross(vertices[k], vertices[k + 1]) > 0;
  }
  return inside ? 0 : nearest;
}

double normal_probability(const std::array<Eigen::Vector2d, 3>& t) {
  return edge_probability(t[0], t[1]) + edge_probability(t[1], t[2]) + edge_probability(t[2], t[0]);
}

void integrate_triangle(const std::array<Whitened, 3>& vertices, double area, const TriangleRules& rules,
                        RunningIntegral* integral) {
  const PlanarTriangle planar = flatten(vertices);
  const double nearest = planar.nearest_squared();
  if (nearest >= integral->cut()) return integral->skip(area, nearest);

  const Gram gram = gram_of(vertices);
  const int rule = choose_rule(rules, gram, integral->digits_at(nearest));
  if (rule < rules.count()) {
    const double value = area * rules.rule(rule).mean(gram);
    return integral->add(value, value * integral->tolerance_at(nearest));
  }

  constexpr double wide = 4;  // below, a few halvings cost less than Owen's T
  const double density = area * kTwoPi * std::exp(-0.5 * planar.offset_squared) / planar.area();
  const double reach =
      std::max({planar.vertices[0].norm(), planar.vertices[1].norm(), planar.vertices[2].norm()});
  const double rounding = density * (1e-15 + 4e-16 * reach);
  if (planar.diameter() > wide && integral->allows(rounding, area * std::exp(-0.5 * nearest), area)) {
    const double value = std::max(0.0, density * normal_probability(planar.vertices));
    if (integral->allows(rounding, value, area)) return integral->add(value, rounding);
  }

  const Whitened &a = vertices[planar.order[0]], &b = vertices[planar.order[1]],
                 &c = vertices[planar.order[2]];
  const Whitened middle = 0.5 * (a + b);
  integrate_triangle({a, middle, c}, 0.5 * area, rules, integral);
  integrate_triangle({middle, b, c}, 0.5 * area, rules, integral);
}

}  // namespace mica::host::reference
