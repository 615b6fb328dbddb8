#include "host/render/film.h"

#include <algorithm>

namespace mica::host {

Film::Film(int width, int height, const std::vector<std::string>& channels) {
  image_.width = width;
  image_.height = height;
  image_.channels = channels;
  image_.pixels.assign(static_cast<std::size_t>(width) * height * channels.size(), 0.0f);
}

float* Film::channel(const std::string& name, std::size_t pixel) {
  const auto found = std::find(image_.channels.begin(), image_.channels.end(), name);
  if (found == image_.channels.end()) return nullptr;
  return &image_.pixels[pixel * image_.channels.size() + (found - image_.channels.begin())];
}

void Film::add(const TracedRows& rows, const std::vector<float>& densities,
               const std::vector<float>& errors) {
  const std::size_t first_pixel = static_cast<std::size_t>(rows.first_row) * image_.width;
  const std::size_t stride = image_.channels.size();
  const std::size_t pixels = static_cast<std::size_t>(rows.row_count) * image_.width;
  const auto write = [&](const std::string& name, auto value_of_pixel) {
    float* out = channel(name, first_pixel);
    for (std::size_t pixel = 0; out && pixel < pixels; ++pixel) out[pixel * stride] = value_of_pixel(pixel);
  };

  std::vector<Eigen::Vector3d> radiance(pixels);
  std::vector<double> density_sum(pixels, 0.0), error_sum(pixels, 0.0);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) radiance[pixel] = rows.radiance[pixel].cast<double>();
  for (std::size_t n = 0; n < densities.size(); ++n) {
    const GlintQuery& glint = rows.queries[n];
    radiance[glint.pixel] += glint.weight.cast<double>() * static_cast<double>(densities[n]);
    density_sum[glint.pixel] += densities[n];
    if (!errors.empty()) error_sum[glint.pixel] += errors[n];
  }

  const char* const colors[] = {"R", "G", "B"};
  for (int c = 0; c < 3; ++c)
    write(colors[c], [&](std::size_t pixel) { return static_cast<float>(radiance[pixel][c]); });
  write("ndf.Y", [&](std::size_t pixel) {
    return static_cast<float>(density_sum[pixel] / std::max<int>(rows.query_count[pixel], 1));
  });
  write("error.Y", [&](std::size_t pixel) {
    return static_cast<float>(error_sum[pixel] / std::max<int>(rows.query_count[pixel], 1));
  });
  write("uv.U", [&](std::size_t pixel) { return rows.uv[pixel].x(); });
  write("uv.V", [&](std::size_t pixel) { return rows.uv[pixel].y(); });
  write("footprint.CUU", [&](std::size_t pixel) { return rows.footprint[pixel].x(); });
  write("footprint.CUV", [&](std::size_t pixel) { return rows.footprint[pixel].y(); });
  write("footprint.CVV", [&](std::size_t pixel) { return rows.footprint[pixel].z(); });
  write("normal.X", [&](std::size_t pixel) { return rows.normal[pixel].x(); });
  write("normal.Y", [&](std::size_t pixel) { return rows.normal[pixel].y(); });
  write("normal.Z", [&](std::size_t pixel) { return rows.normal[pixel].z(); });
  write("queries.Y", [&](std::size_t pixel) { return static_cast<float>(rows.query_count[pixel]); });
}

}  // namespace mica::host
