#include <fmt/format.h>

#include "host/surface/gaussian_heightfield.h"
#include "host/surface/settings.h"
#include "host/surface/synthesis.h"
#include "mica/error.h"

namespace mica::host {
namespace {

void check(const SpectrumSurface& spectrum) {
  synthesis::check_resolution("spectrum", spectrum.resolution);
  synthesis::check_setting("spectrum", "rms_slope", spectrum.rms_slope, 0, 5);
  if (!(spectrum.correlation_texels > 0 && spectrum.correlation_texels <= spectrum.resolution)) {
    throw UsageError(
        fmt::format("spectrum: correlation is {} texels, expected above 0 and at most the resolution ({})",
                    spectrum.correlation_texels, spectrum.resolution));
  }
}

}  // namespace

std::vector<Eigen::Vector2d> synthesise_spectrum(const SpectrumSurface& spectrum, SurfaceReport& report) {
  check(spectrum);
  if (spectrum.correlation_texels < 2) {
    report.warnings.push_back(
        fmt::format("spectrum: a correlation of {} texels is finer than the texels resolve; the map's is "
                    "longer (use 2 or more)",
                    spectrum.correlation_texels));
  }
  if (4 * spectrum.correlation_texels > spectrum.resolution) {
    report.warnings.push_back(fmt::format(
        "spectrum: a correlation of {} texels leaves few features in a period of {}; the map's is shorter",
        spectrum.correlation_texels, spectrum.resolution));
  }
  const double squared = spectrum.correlation_texels * spectrum.correlation_texels;
  return synthesis::gaussian_heightfield(spectrum.resolution, spectrum.rms_slope,
                                         squared * Eigen::Matrix2d::Identity(), spectrum.seed);
}

}  // namespace mica::host
