#include "host/render/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/render/luminance.h"
#include "host/scene/aovs.h"
#include "host/scene/lamp_samples.h"

namespace mica::host {

namespace {

void blacken_what_is_not_finite(std::vector<Eigen::Vector3d>* light, FilmRepairs* repairs) {
  constexpr double largest = std::numeric_limits<float>::max();
  for (Eigen::Vector3d& color : *light) {
    if (color.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= largest) continue;
    color.setZero();
    ++repairs->not_finite;
  }
}

}  // namespace

std::vector<Eigen::Vector3d> sample_radiance_of(const TracedRows& rows, const std::vector<float>& densities,
                                                FilmRepairs* repairs) {
  std::vector<Eigen::Vector3d> radiance(rows.sample_radiance.size());
  for (std::size_t n = 0; n < radiance.size(); ++n) radiance[n] = rows.sample_radiance[n].cast<double>();
  for (std::size_t n = 0; n < densities.size(); ++n)
    if (const GlintQuery& glint = rows.queries[n]; glint.sample != GlintQuery::kNone)
      radiance[glint.sample] += glint.weight.cast<double>() * static_cast<double>(densities[n]);
  blacken_what_is_not_finite(&radiance, repairs);  // before neighbouring pixels share them
  return radiance;
}

std::vector<Eigen::Vector3d> radiance_of(const TracedRows& rows, const std::vector<float>& densities,
                                         FilmRepairs* repairs) {
  std::vector<Eigen::Vector3d> radiance(rows.radiance.size());
  for (std::size_t pixel = 0; pixel < radiance.size(); ++pixel)
    radiance[pixel] = rows.radiance[pixel].cast<double>();
  for (std::size_t n = 0; n < densities.size(); ++n)
    if (const GlintQuery& glint = rows.queries[n]; glint.sample == GlintQuery::kNone)
      radiance[glint.pixel] += glint.weight.cast<double>() * static_cast<double>(densities[n]);
  const std::vector<Eigen::Vector3d> sample_radiance = sample_radiance_of(rows, densities, repairs);
  add_samples(rows, sample_radiance, &radiance);
  add_lamp_samples(rows, densities, &radiance);
  blacken_what_is_not_finite(&radiance, repairs);
  for (Eigen::Vector3d& color : radiance) {
    if (color.minCoeff() >= 0) continue;
    color = color.cwiseMax(0);
    ++repairs->negative;
  }
  return radiance;
}

std::vector<double> pixel_errors(const TracedRows& rows, const std::vector<float>& densities,
                                 const std::vector<float>& errors) {
  std::vector<double> of_densities(rows.radiance.size()), squares(rows.radiance.size());
  for (std::size_t pixel = 0; pixel < squares.size(); ++pixel)
    squares[pixel] = static_cast<double>(rows.doubt[pixel]) * static_cast<double>(rows.doubt[pixel]);
  const double of_a_sample = 1.0 / (rows.lattice.subpixels * rows.lattice.subpixels);
  for (std::size_t n = 0; n < densities.size(); ++n) {
    const GlintQuery& glint = rows.queries[n];
    if (glint.pixel == GlintQuery::kNone) continue;
    const bool is_sample = glint.sample != GlintQuery::kNone;  // the doubt has what its footprint leaves out
    const double weight = luminance(glint.weight.cast<double>()) * (is_sample ? of_a_sample : 1);
    of_densities[glint.pixel] += weight * static_cast<double>(errors[n]);
    const double missed = std::hypot(is_sample ? 0 : static_cast<double>(glint.missed_by_footprint),
                                     static_cast<double>(glint.missed_by_lamp));
    squares[glint.pixel] += std::pow(weight * static_cast<double>(densities[n]) * missed, 2);
  }
  for (std::size_t pixel = 0; pixel < squares.size(); ++pixel)
    squares[pixel] = std::sqrt(squares[pixel] + of_densities[pixel] * of_densities[pixel]);
  return squares;
}

Film::Film(int width, int height, const std::vector<std::string>& channels, int first_row) {
  image_.width = width;
  image_.height = height;
  image_.first_row = first_row;
  image_.channels = channels;
  image_.pixels.assign(static_cast<std::size_t>(width) * height * channels.size(), 0.0f);
}

void Film::write(std::size_t first_pixel, const std::string& first_channel, std::size_t pixels,
                 const std::function<void(std::size_t pixel, float* out)>& write_pixel) {
  const auto found = std::find(image_.channels.begin(), image_.channels.end(), first_channel);
  if (found == image_.channels.end()) return;
  const std::size_t stride = image_.channels.size();
  float* out =
      &image_.pixels[first_pixel * stride + static_cast<std::size_t>(found - image_.channels.begin())];
  for (std::size_t pixel = 0; pixel < pixels; ++pixel, out += stride) write_pixel(pixel, out);
}

void Film::add(const TracedRows& rows, const std::vector<float>& densities,
               const std::vector<float>& errors) {
  const std::size_t first_pixel = static_cast<std::size_t>(rows.first_row - image_.first_row) * image_.width;
  const std::size_t pixels = static_cast<std::size_t>(rows.row_count) * image_.width;

  const std::vector<Eigen::Vector3d> radiance = radiance_of(rows, densities, &repairs_);
  std::vector<double> density_sum(pixels, 0.0);
  for (std::size_t n = 0; n < densities.size(); ++n)
    if (const GlintQuery& glint = rows.queries[n]; glint.pixel != GlintQuery::kNone)
      density_sum[glint.pixel] += densities[n];
  const std::vector<double> error =
      errors.empty() ? std::vector<double>(pixels, 0.0) : pixel_errors(rows, densities, errors);

  write(first_pixel, "R", pixels, [&](std::size_t pixel, float* out) {
    Eigen::Map<Eigen::Vector3f>{out} = radiance[pixel].cast<float>();
  });
  for (const Aov& aov : aovs())
    write(first_pixel, aov.channel(0), pixels, [&](std::size_t pixel, float* out) {
      aov.write({rows, pixel, density_sum[pixel], error[pixel]}, out);
      for (std::size_t part = 0; part < aov.parts.size(); ++part)
        if (!std::isfinite(out[part])) out[part] = 0, ++repairs_.not_finite;
    });
}

}  // namespace mica::host
