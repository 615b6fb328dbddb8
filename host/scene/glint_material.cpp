#include "host/scene/glint_material.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/microfacet/glint_masking.h"
#include "host/scene/footprint.h"

namespace mica::host {
namespace {

constexpr int kStretchSteps = 8;       // steps of a texture, from round to the material's stretch
constexpr double kLeastCosine = 0.02;  // a plane of the world that is seen at less has no share
constexpr double kLeastRoughness = 1e-4;
constexpr double kPeriod =
    1 << 20;  // repeated uv start again here: further out, cells would be lost to rounding

std::optional<Texture> texture_of(const std::string& path) {
  if (path.empty()) return std::nullopt;
  return Texture(path);
}

double factor(const std::optional<Texture>& texture, const Eigen::Vector2d& uv) {
  return texture ? std::clamp(texture->at(uv).x(), 0.0, 1.0) : 1;
}

Eigen::Vector2d wrapped(const Eigen::Vector2d& uv) {
  return uv - kPeriod * (uv / kPeriod).array().floor().matrix();
}

/// Density in steps of four, each a grid of its own, of which the texture leaves a share: cells that followed
/// it smoothly would be torn apart far from the origin.
void set_density(double density, double factor, GlintPoint* point) {
  const double wanted = std::max(density * factor, 1.0);
  const double step = std::exp2(2 * std::floor(std::log2(density / wanted) / 2));
  point->density = static_cast<float>(density / step);
  point->kept = static_cast<float>(std::min(wanted * step / density, 1.0));
}

}  // namespace

GlintMaterial::GlintMaterial(const MaterialDescription& material)
    : material_(material),
      glints_(material.glints.value()),
      density_(texture_of(glints_.textures.density)),
      alpha_(texture_of(glints_.textures.alpha)),
      microroughness_(texture_of(glints_.textures.microroughness)),
      stretch_(texture_of(glints_.textures.stretch)),
      color_(texture_of(glints_.textures.color)) {}

Eigen::Vector2d GlintMaterial::alpha_at(const Eigen::Vector2d& uv) const {
  return (glints_.alpha * factor(alpha_, uv)).cwiseMax(kLeastRoughness);
}

double GlintMaterial::microroughness(const Eigen::Vector2d& uv) const {
  return std::max(material_.roughness * factor(microroughness_, uv), kLeastRoughness);
}

Color GlintMaterial::tint(const Eigen::Vector2d& uv) const {
  return color_ ? Color(color_->at(uv).cwiseMax(0).cwiseMin(1)) : Color::Ones();
}

SmoothNormals GlintMaterial::from_afar(const Eigen::Vector2d& uv) const {
  Color mean = Color::Zero();
  for (const Color& color : glints_.colors) mean += color / static_cast<double>(glints_.colors.size());
  return {SmoothLobe(glints_, alpha_at(uv)),
          glints_.colors.empty() ? tint(uv) : Color(mean.cwiseProduct(tint(uv)))};
}

std::vector<GlintPlace> GlintMaterial::places(const CameraRay& ray, const Hit& hit, const TangentFrame& frame,
                                              double sigma_pixels) const {
  GlintPlace place;
  const Eigen::Vector2d alpha = alpha_at(hit.uv);
  place.microroughness = microroughness(hit.uv);
  place.point.distribution = glints_.distribution;
  place.point.alpha_x = static_cast<float>(alpha.x()), place.point.alpha_y = static_cast<float>(alpha.y());
  place.point.stretch = static_cast<float>(glints_.stretch);
  place.point.seed = glints_.seed;
  set_density(glints_.density, factor(density_, hit.uv), &place.point);

  std::vector<GlintPlace> places;
  if (glints_.mapping == GlintsDescription::Mapping::triplanar) {
    places.assign(3, place);
    split_by_plane(ray, hit, frame, sigma_pixels, &places);
    return places;
  }
  place.x = frame.x, place.y = frame.y;
  place.footprint.mean_uv = wrapped(hit.uv.cwiseProduct(material_.repeat));
  const Eigen::Matrix2d duv = material_.repeat.asDiagonal() * uv_differentials(ray, hit);
  place.footprint.cov_uv = footprint_covariance(duv, sigma_pixels);
  places.push_back(place);
  if (stretch_) split_by_stretch(hit.uv, &places);
  return places;
}

/// The step below the texture's stretch and the one above share the light.
void GlintMaterial::split_by_stretch(const Eigen::Vector2d& uv, std::vector<GlintPlace>* places) const {
  const double steps = kStretchSteps * factor(stretch_, uv);
  const int below = std::min(static_cast<int>(steps), kStretchSteps - 1);
  places->push_back(places->front());
  for (int n = 0; n < 2; ++n) {
    GlintPoint& point = (*places)[static_cast<std::size_t>(n)].point;
    point.stretch = static_cast<float>(std::pow(glints_.stretch, double(below + n) / kStretchSteps));
    point.seed += static_cast<std::uint32_t>(below + n);
    point.share = static_cast<float>(n == 0 ? 1 - (steps - below) : steps - below);
  }
  const auto empty = [](const GlintPlace& place) { return place.point.share <= 0; };
  places->erase(std::remove_if(places->begin(), places->end(), empty), places->end());
}

/// Three processes, one on each plane of the world's axes. [Kem25] sec. 3.3.6
void GlintMaterial::split_by_plane(const CameraRay& ray, const Hit& hit, const TangentFrame& frame,
                                   double sigma_pixels, std::vector<GlintPlace>* places) const {
  const Eigen::Vector3d cosines = (frame.z.cwiseAbs().array() - kLeastCosine).cwiseMax(0);
  const Eigen::Matrix<double, 3, 2> differentials = position_differentials(ray, hit);
  for (int axis = 0; axis < 3; ++axis) {
    GlintPlace& place = (*places)[static_cast<std::size_t>(axis)];
    const int across = (axis + 1) % 3, up = (axis + 2) % 3;
    place.point.share = static_cast<float>(cosines[axis] / cosines.sum());
    place.point.seed += static_cast<std::uint32_t>(axis);
    if (place.point.share <= 0) continue;
    place.x = (Eigen::Vector3d::Unit(across) - frame.z[across] * frame.z).normalized();
    place.y = frame.z.cross(place.x);
    const Eigen::Vector2d position(hit.position[across], hit.position[up]);
    place.footprint.mean_uv = wrapped(position.cwiseProduct(material_.repeat));
    Eigen::Matrix2d duv;
    duv << differentials.row(across) * material_.repeat.x(), differentials.row(up) * material_.repeat.y();
    place.footprint.cov_uv = footprint_covariance(duv, sigma_pixels);
  }
  const auto empty = [](const GlintPlace& place) { return place.point.share <= 0; };
  places->erase(std::remove_if(places->begin(), places->end(), empty), places->end());
}

Color GlintMaterial::weight(const Hit& hit, const TangentFrame& frame, const LobesSeen& seen) const {
  const Eigen::Vector2d alpha = alpha_at(hit.uv).cast<float>().cast<double>();  // as queries have it
  const Eigen::Vector3d view = frame.to_local(seen.to_eye), light = frame.to_local(seen.to_light);
  const double G = glint_masking(glints_.distribution, glints_.masking, alpha, view, light);
  return seen.mirrored.cwiseProduct(tint(hit.uv)) * (G / (4 * view.z()));
}

double GlintMaterial::widened(double microroughness, const LobesSeen& seen) const {
  const double more = seen.roughness * seen.roughness - material_.roughness * material_.roughness;
  return std::min(std::sqrt(microroughness * microroughness + std::max(more, 0.0)), 1.0);
}

}  // namespace mica::host
