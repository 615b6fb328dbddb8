#include "host/scene/base_energy.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/constants.h"
#include "host/microfacet/masking.h"
#include "host/scene/fresnel.h"

namespace mica::host {
namespace {

constexpr Eigen::Index kCells = 48;    // of the cosines outside
constexpr Eigen::Index kTrapped = 16;  // of the cosines beyond a coat's critical angle
constexpr int kSlopes = 256;           // of the base, of equal weight
constexpr int kBounces = 256;          // in a coat; each loses what leaves
constexpr int kBalancingSteps = 64;
constexpr double kLeastCosine = 1e-3;

/// Cosine in a coat of a direction outside. Snell.
double inside(double cos_outside, double ior) {
  return std::sqrt(1 - (1 - cos_outside * cos_outside) / (ior * ior));
}

double transmittance(double cos_outside, double ior) {
  return 1 - dielectric_reflectance(cos_outside, ior);
}

/// Between the rows of a table; `place` counts them.
Color interpolated(const Eigen::ArrayX3d& table, double place) {
  const auto row = std::min(static_cast<Eigen::Index>(place), table.rows() - 2);
  const double share = place - static_cast<double>(row);
  return ((1 - share) * table.row(row) + share * table.row(row + 1)).transpose().matrix();
}

/// 2 int f(c) c dc over [0, 1], by the midpoint rule.
template <typename Function>
Color cosine_mean(const Function& f) {
  constexpr int steps = 256;
  Color sum = Color::Zero();
  for (int n = 0; n < steps; ++n) {
    const double cosine = (n + 0.5) / steps;
    sum += 2 * cosine / steps * f(cosine);
  }
  return sum;
}

}  // namespace

BaseEnergy::BaseEnergy(const MaterialDescription& material, double alpha)
    : albedo_(material.diffuse),
      ior_(material.coat ? material.coat->ior : 1),
      trapped_(material.coat ? kTrapped : 0),
      size_(trapped_ + kCells + 1) {
  const Spread spread = mirror(material.specular, alpha);
  scattered_ = repeated_ = passed_;
  for (Eigen::Index channel = 0; channel < 3; ++channel)
    if (trapped_ > 0) sum_bounces(spread[static_cast<std::size_t>(channel)], channel);
  const Color leaving_outside = cosine_mean([&](double cosine) -> Color {
    return transmittance(cosine, ior_) * interpolated(scattered_, place(inside(cosine, ior_)));
  });
  const Color leaving_base =
      ior_ * ior_ * cosine_mean([&](double cosine) { return interpolated(passed_, place(cosine)); });
  // Of what the diffuse lobe sends up, over the squared index times the solid angle, the first share leaves
  // the coat, and the rest returns to it. Where a mirror takes all there is neither.
  const Color shares =
      ((1 - albedo_.array()) * leaving_base.array() + albedo_.array() * leaving_outside.array()).matrix();
  diffuse_scale_ = (shares.array() > 1e-9).select(albedo_.array() / (kPi * shares.array()), 0.0).matrix();
}

/// Nodes are at equal steps of the cosine up to that of the critical angle, and then of the cosine outside.
double BaseEnergy::place(double cos_inside) const {
  const double outside2 = 1 - ior_ * ior_ * (1 - cos_inside * cos_inside);
  if (outside2 >= 0) return static_cast<double>(trapped_) + static_cast<double>(kCells) * std::sqrt(outside2);
  return static_cast<double>(trapped_) * cos_inside / inside(0, ior_);
}

double BaseEnergy::cosine(Eigen::Index node) const {
  if (node < trapped_)
    return std::max(inside(0, ior_) * static_cast<double>(node) / static_cast<double>(trapped_),
                    kLeastCosine);
  return inside(std::max(static_cast<double>(node - trapped_) / kCells, kLeastCosine), ior_);
}

/// Share of the light that rises along a node's direction that leaves the coat.
double BaseEnergy::leaving(Eigen::Index node) const {
  if (node < trapped_) return 0;
  return transmittance(std::max(static_cast<double>(node - trapped_) / kCells, kLeastCosine), ior_);
}

/// What the base mirrors, by the nodes of a table: (n, m) of the light that comes along n leaves along m, by
/// one bounce of a Beckmann lobe with Smith's masking. Also fills `passed_`.
BaseEnergy::Spread BaseEnergy::mirror(const Fresnel& specular, double alpha) {
  Spread spread;
  spread.fill(Eigen::MatrixXd::Zero(size_, size_));
  passed_ = Table::Zero(size_, 3);
  for (Eigen::Index n = 0; n < size_; ++n) {
    const double cos_o = cosine(n), sin_o = std::sqrt(1 - cos_o * cos_o);
    double seen = 0;
    Color taken = Color::Zero();
    for (int k = 0; k < kSlopes; ++k) {  // turns by the golden ratio; both halves of a turn are alike
      const double radius = alpha * std::sqrt(-std::log((k + 0.5) / kSlopes)),
                   turn = kPi * std::fmod(0.6180339887498949 * k, 1.0);
      const double facing = cos_o - radius * std::cos(turn) * sin_o;
      if (facing <= 0) continue;
      const double cos_h = 1 / std::sqrt(1 + radius * radius);
      const Color fresnel = reflectance(specular, facing * cos_h);
      seen += facing, taken += facing * fresnel;
      const double cos_i = 2 * facing * cos_h * cos_h - cos_o;
      if (cos_i < kLeastCosine) continue;
      const double share = facing / (cos_o * kSlopes) * smith_masking_shadowing(cos_o, cos_i, alpha);
      const double at = place(std::min(cos_i, 1.0));
      const auto m = std::min(static_cast<Eigen::Index>(at), size_ - 2);
      for (std::size_t channel = 0; channel < spread.size(); ++channel) {
        spread[channel](n, m) += share * fresnel[channel] * (1 - (at - m));
        spread[channel](n, m + 1) += share * fresnel[channel] * (at - m);
      }
    }
    passed_.row(n) = (1 - taken.array() / seen).transpose();
  }
  return spread;
}

/// The series of all bounces, x = first + spread (1 - leaving) x: of what gets to the diffuse lobe, and of
/// what leaves mirrored. A factor that is a product g(o) g(i), and so reciprocal, makes of light that was
/// mirrored once as much as that, for every direction: g(o) int once(o, i) g(i) = all(o). [Sinkhorn and Knopp
/// 1967]
void BaseEnergy::sum_bounces(const Eigen::MatrixXd& spread, Eigen::Index channel) {
  Eigen::ArrayXd leave(size_);
  for (Eigen::Index n = 0; n < size_; ++n) leave[n] = leaving(n);
  const Eigen::ArrayXd once = (spread * leave.matrix()).array(), passed = passed_.col(channel);
  Eigen::ArrayXd all = once, scattered = passed, g = Eigen::ArrayXd::Ones(size_);
  for (int bounce = 0; bounce < kBounces; ++bounce) {
    scattered = passed + (spread * ((1 - leave) * scattered).matrix()).array();
    all = once + (spread * ((1 - leave) * all).matrix()).array();
  }
  for (int step = 0; step < kBalancingSteps; ++step) {
    const Eigen::ArrayXd scaled = g * (spread * (leave * g).matrix()).array();
    g *= (scaled > 1e-9).select((all / scaled.max(1e-9)).sqrt(), 1.0);
  }
  scattered_.col(channel) = scattered, repeated_.col(channel) = g;
}

Color BaseEnergy::diffuse(double cos_o, double cos_i) const {
  const Color view = interpolated(scattered_, place(inside(cos_o, ior_))),
              light = interpolated(scattered_, place(inside(cos_i, ior_)));
  return diffuse_scale_.cwiseProduct(view.cwiseProduct(light)) *
         (transmittance(cos_o, ior_) * transmittance(cos_i, ior_));
}

Color BaseEnergy::mirrored(double cos_below) const {
  return Color::Ones() - interpolated(passed_, place(cos_below));
}

Color BaseEnergy::interreflection(double cos_o, double cos_i) const {
  if (trapped_ == 0) return Color::Ones();
  return interpolated(repeated_, place(inside(cos_o, ior_)))
      .cwiseProduct(interpolated(repeated_, place(inside(cos_i, ior_))));
}

}  // namespace mica::host
