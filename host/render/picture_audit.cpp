#include "host/render/picture_audit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/base/error_norms.h"
#include "host/base/random.h"
#include "host/methods/auto/sampled_error.h"
#include "host/render/film.h"
#include "host/render/luminance.h"
#include "host/render/pending_block.h"

namespace mica::host {
namespace {

constexpr std::uint64_t kDraws = 0x70697865;   // a stream of its own
constexpr int kFewestSubpixels = 4;            // of a reference
constexpr int kMostSubpixels = 32;             // likewise
constexpr double kAgreementOfTolerance = 0.1;  // of two references
constexpr double kQuantile = 1.6449;           // of the normal distribution, at 95%

struct DrawnPixel {
  int row, column;
  double scale;  ///< of its light: its square is the number of pixels that it stands for
  double luminance;
};

/// Pixels drawn one after the other at even steps of the sum of weights, each its luminance and the mean.
std::vector<DrawnPixel> draw_pixels(const Image& image, int count, std::uint64_t seed) {
  const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const std::size_t stride = image.channels.size();
  const auto red = static_cast<std::size_t>(std::find(image.channels.begin(), image.channels.end(), "R") -
                                            image.channels.begin());
  const auto light = [&](std::size_t pixel) {
    return luminance(Eigen::Map<const Eigen::Vector3f>(&image.pixels[pixel * stride + red]).cast<double>());
  };
  double mean = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) mean += light(pixel) / static_cast<double>(pixels);
  if (!(mean > 0)) return {};
  std::vector<DrawnPixel> drawn;
  const double step = 2 * mean * static_cast<double>(pixels) / count;
  double next = step * random_unit(seed, kDraws, 0), sum = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const double weight = light(pixel) + mean;
    for (sum += weight; next < sum; next += step)
      drawn.push_back({image.first_row + static_cast<int>(pixel / static_cast<std::size_t>(image.width)),
                       static_cast<int>(pixel % static_cast<std::size_t>(image.width)),
                       std::sqrt(step / weight), light(pixel)});
  }
  return drawn;
}

/// Pixels as sums of small footprints under lamps in many parts, or as the picture has them.
class Reference {
 public:
  explicit Reference(const BuiltJob& built)
      : built_(built), of_picture_(built.evaluators()), evaluators_(of_picture_) {
    for (std::size_t n = 0; n < evaluators_.size(); ++n) {
      made_.push_back(evaluators_[n] ? built.make_exact_evaluator(n) : nullptr);
      if (made_[n]) evaluators_[n] = made_[n].get();
    }
    const ImageSettings& image = built.job().image;
    pixels_.filter = PixelFilter(image.filter).for_reference(image.subpixels);
    for (const int evaluator : built.plan().evaluator_of_material) {
      pixels_.takes_first_order.push_back(evaluator >= 0 && made_[static_cast<std::size_t>(evaluator)]);
    }
  }

  /// Luminance of the drawn pixels, scaled.
  std::vector<float> evaluate(const std::vector<DrawnPixel>& drawn, int subpixels) {
    pixels_.subpixels = subpixels;
    pixels_.lamp_parts =
        LampParts::of(kMostLampParts, kAgreementOfTolerance * built_.job().accuracy.tolerance);
    return evaluate(drawn, pixels_, evaluators_);
  }
  std::vector<float> under_lamps_of_picture(const std::vector<DrawnPixel>& drawn, int subpixels) {
    pixels_.subpixels = subpixels;
    pixels_.lamp_parts = built_.scene().pixels().lamp_parts;
    return evaluate(drawn, pixels_, evaluators_);
  }
  /// The picture's footprints before any are refined, by its own methods or by exact ones.
  std::vector<float> of_picture(const std::vector<DrawnPixel>& drawn, bool exact) {
    return evaluate(drawn, built_.scene().pixels(), exact ? evaluators_ : of_picture_);
  }

 private:
  std::vector<float> evaluate(const std::vector<DrawnPixel>& drawn, const PixelSettings& pixels,
                              const std::vector<Evaluator*>& evaluators) {
    std::vector<float> result;
    for (const DrawnPixel& pixel : drawn) {
      PendingBlock block(built_.scene().trace_pixel(pixel.row, pixel.column, pixels), built_, evaluators);
      const std::vector<float> densities = block.wait();
      FilmRepairs repairs;  // the picture has counted its own
      result.push_back(static_cast<float>(pixel.scale *
                                          luminance(radiance_of(block.rows(), densities, &repairs).front())));
    }
    return result;
  }

  const BuiltJob& built_;
  std::vector<Evaluator*> of_picture_;
  std::vector<std::unique_ptr<Evaluator>> made_;
  std::vector<Evaluator*> evaluators_;
  PixelSettings pixels_;
};

/// Lengths of the three differences that add up to that of what is shown from what is expected.
void tell_parts(const AuditedPixels& pixels, PictureAudit* audit) {
  double densities = 0, footprints = 0, lamps = 0, all = 0;
  for (std::size_t n = 0; n < pixels.shown.size(); ++n) {
    const double of_densities = double(pixels.own[n]) - double(pixels.exact[n]),
                 of_lamps = double(pixels.under_its_lamps[n]) - double(pixels.expected[n]),
                 difference = double(pixels.shown[n]) - double(pixels.expected[n]);
    densities += of_densities * of_densities, lamps += of_lamps * of_lamps;
    footprints += std::pow(difference - of_densities - of_lamps, 2);
    all += double(pixels.expected[n]) * double(pixels.expected[n]);
  }
  if (!(all > 0)) return;
  audit->of_densities = std::sqrt(densities / all), audit->of_lamps = std::sqrt(lamps / all);
  audit->of_footprints = std::sqrt(footprints / all);
}

}  // namespace

AuditedPixels audit_pixels(const BuiltJob& built, const Image& image) {
  AuditedPixels audited;
  const Job& job = built.job();
  if (job.audit.pixels == 0 || !can_audit_pixels(built.plan())) return audited;
  const auto share =
      static_cast<int>(static_cast<std::int64_t>(job.audit.pixels) * image.height / job.image.height);
  const std::vector<DrawnPixel> drawn = draw_pixels(image, std::max(share, 1), job.seed);
  if (drawn.empty()) return audited;
  for (const DrawnPixel& pixel : drawn)
    audited.shown.push_back(static_cast<float>(pixel.scale * pixel.luminance));
  Reference reference(built);
  const bool of_subpixels = job.image.filter.kind == FilterKind::subpixels;
  const int fewest = of_subpixels ? std::max(kFewestSubpixels, 2 * job.image.subpixels) : kFewestSubpixels;
  audited.expected = reference.evaluate(drawn, fewest);
  for (audited.subpixels = 2 * fewest;; audited.subpixels *= 2) {
    const std::vector<float> coarser = std::move(audited.expected);
    audited.expected = reference.evaluate(drawn, audited.subpixels);
    audited.reference_l2 = relative_l2(coarser, audited.expected);
    if (audited.subpixels >= kMostSubpixels ||
        audited.reference_l2 <= kAgreementOfTolerance * job.accuracy.tolerance)
      break;
  }
  audited.own = reference.of_picture(drawn, false), audited.exact = reference.of_picture(drawn, true);
  audited.under_its_lamps = reference.under_lamps_of_picture(drawn, audited.subpixels);
  return audited;
}

PictureAudit picture_audit(const AuditedPixels& pixels) {
  PictureAudit audit;
  if (pixels.shown.size() < 2) return audit;
  const SampledError error = sampled_error(pixels.shown, pixels.expected, kQuantile);
  audit.pixels = static_cast<int>(pixels.shown.size());
  audit.relative_l2 = error.relative_l2;
  audit.upper_bound = error.upper_bound + pixels.reference_l2;
  audit.subpixels = pixels.subpixels;
  audit.reference_l2 = pixels.reference_l2;
  tell_parts(pixels, &audit);
  return audit;
}

std::string describe(const PictureAudit& audit) {
  return fmt::format(
      "{} pixels, relative L2 {:.3g}, at most {:.3g} at 95%; of densities {:.3g}, footprints {:.3g}, lamps "
      "{:.3g}",
      audit.pixels, audit.relative_l2, audit.upper_bound, audit.of_densities, audit.of_footprints,
      audit.of_lamps);
}

}  // namespace mica::host
