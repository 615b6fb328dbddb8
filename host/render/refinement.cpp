#include "host/render/refinement.h"

#include <algorithm>
#include <cmath>

#include "host/base/random.h"
#include "host/render/film.h"
#include "host/render/gather_light.h"
#include "host/render/luminance.h"
#include "host/render/pending_block.h"

namespace mica::host {
namespace {

constexpr std::uint64_t kLooks = 0x6c6f6f6b;  // a stream of random numbers
constexpr int kLooksAlong = 16;               // rows that are looked at, and pixels of each
constexpr int kLookSubpixels = 2;             // of those pixels
constexpr std::size_t kFewQueries = 1024;
constexpr int kFinestBy = 8;  // along each axis
/// Of the root mean square of a picture and its tolerance: a change of a pixel that may stay, in a picture
/// 160 pixels wide. The pixels that need samples lie along lines: the wider a picture is the fewer they are.
constexpr double kChangeOfTolerance = 2, kWidth = 160;
/// How much less than their doubt pixels change: a third of it, root mean square, where it was measured.
constexpr double kChangeOfDoubt = 1.0 / 3;
/// Of a change by samples twice as dense: how much more four times as dense ones would change.
constexpr double kChangeOfHalf = 0.5;
/// Of the change of a pixel that may stay, what a sample's may be: a dozen of them lie along an edge, and the
/// truth of each is somewhere between itself and the sample across the edge.
constexpr double kUnevenOfChange = 0.1;

using Colors = std::vector<Eigen::Vector3d>;

/// Queries, and those of them that no normal could answer.
struct Asked {
  std::size_t queries = 0, dropped = 0;
};

struct Samples {
  Lattice lattice;
  Colors radiance;
  std::vector<double> hidden;  ///< luminance of what shadows hide from them
  std::vector<double> missed;  ///< relative L2 of what their footprints leave out

  /// What a sample's luminance may be off by for what lies in its footprint: an edge of a shadow, or a
  /// surface that turns away from the eye.
  /// @param expected what such samples show on an average: a glint that it misses has more.
  double unsure(std::size_t sample, double expected) const {
    return std::max(hidden[sample], missed[sample] * std::max(expected, luminance(radiance[sample])));
  }

  /// Sample (i, j) of those that a pixel sees, from the first one of the first pixel within reach.
  const Eigen::Vector3d& at(int row, int column, std::size_t i, std::size_t j) const {
    return radiance[place(row, column, i, j)];
  }
  std::size_t place(int row, int column, std::size_t i, std::size_t j) const {
    const auto n = static_cast<std::size_t>(lattice.subpixels);
    const int down = static_cast<int>(j / n) - lattice.margin,
              right = static_cast<int>(i / n) - lattice.margin;
    return lattice.first_sample[lattice.cell(row + down, column + right)] + j % n * n + i % n;
  }
  Eigen::Vector3d sum(int row, int column) const {
    Eigen::Vector3d color = Eigen::Vector3d::Zero();
    lattice.sum(row, column, lattice.all(),
                [&](std::size_t sample, double weight) { color += weight * radiance[sample]; });
    return color;
  }
};

/// What shadows hide from samples, a luminance each.
std::vector<double> hidden_of(const TracedRows& rows, const std::vector<float>& densities) {
  std::vector<double> hidden(rows.sample_radiance.size(), 0.0);
  for (std::size_t n = 0; n < densities.size(); ++n)
    if (const GlintQuery& glint = rows.queries[n]; glint.hidden_weight > 0)
      hidden[glint.sample] += static_cast<double>(glint.hidden_weight) * static_cast<double>(densities[n]);
  return hidden;
}

/// The most that footprints leave out of samples, over lamps.
std::vector<double> missed_of(const TracedRows& rows) {
  std::vector<double> missed(rows.sample_radiance.size(), 0.0);
  for (const GlintQuery& glint : rows.queries)
    if (glint.sample != GlintQuery::kNone)
      missed[glint.sample] = std::max(missed[glint.sample], static_cast<double>(glint.missed_by_footprint));
  return missed;
}

/// Densities of all queries of rows, few at a time: the device has a block of rows in flight besides. Tints
/// the weights of glints.
/// @param dropped counts those that were not asked.
std::vector<float> densities_of(const BuiltJob& built, TracedRows* rows, std::size_t queries_at_a_time,
                                std::size_t* dropped) {
  std::vector<float> densities;
  for (std::size_t first = 0; first < rows->queries.size(); first += queries_at_a_time) {
    const std::size_t count = std::min(queries_at_a_time, rows->queries.size() - first);
    const auto begin = rows->queries.begin() + static_cast<std::ptrdiff_t>(first);
    TracedRows some;
    some.queries.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
    PendingBlock block(std::move(some), built);
    const std::vector<float> answers = block.wait();
    *dropped += block.dropped();
    densities.insert(densities.end(), answers.begin(), answers.end());
    std::copy(block.rows().queries.begin(), block.rows().queries.end(), begin);
  }
  return densities;
}

Samples sample(const BuiltJob& built, int first_row, int row_count, const Lattice::Choice& chosen,
               const PixelSettings& pixels, std::size_t queries_at_a_time, Asked* asked) {
  TracedRows rows = built.scene().sample(first_row, row_count, chosen, pixels);
  asked->queries += rows.queries.size() + add_lit_brdfs(built, &rows);
  const std::vector<float> densities = densities_of(built, &rows, queries_at_a_time, &asked->dropped);
  FilmRepairs repairs;  // what is black for that reason was so before
  return {rows.lattice, sample_radiance_of(rows, densities, &repairs), hidden_of(rows, densities),
          missed_of(rows)};
}

/// Mean square of luminance, by a few pixels all over the picture.
double mean_square(const BuiltJob& built) {
  const ImageSettings& image = built.job().image;
  const auto place = [&](int n, int of, int stream) {
    const double unit =
        (n + random_unit(built.job().seed, kLooks, static_cast<std::uint64_t>(stream))) / kLooksAlong;
    return std::min(static_cast<int>(unit * of), of - 1);
  };
  PixelSettings pixels = built.scene().pixels();
  pixels.fits = pixels.turns = pixels.asks_hidden = false;
  pixels.filter = PixelFilter({});  // of the pixel alone
  pixels.subpixels = kLookSubpixels;
  double sum = 0;
  Asked asked;
  const Lattice lattice = built.scene().lattice(pixels);
  for (int n = 0; n < kLooksAlong; ++n) {
    Lattice::Choice chosen(lattice.cells(1));
    std::vector<int> columns;
    for (int m = 0; m < kLooksAlong; ++m) {
      columns.push_back(place(m, image.width, (n + 1) * kLooksAlong + m));
      chosen[lattice.cell(0, columns.back())].assign(kLookSubpixels * kLookSubpixels, true);
    }
    const Samples samples = sample(built, place(n, image.height, n), 1, chosen, pixels, kFewQueries, &asked);
    for (const int column : columns)
      sum += std::pow(luminance(samples.sum(0, column)), 2) / (kLooksAlong * kLooksAlong);
  }
  return sum;
}

/// Pixels of rows whose samples may be any denser: not those of glints of which smaller footprints see
/// others.
std::vector<bool> pixels_with_limit(const BuiltJob& built, const TracedRows& rows) {
  std::vector<bool> has_limit(rows.fitted.size(), true);
  const Plan& plan = built.plan();
  for (const GlintQuery& query : rows.queries)
    if (query.pixel != GlintQuery::kNone &&
        has_no_limit(plan.evaluators[static_cast<std::size_t>(plan.evaluator_of_material[query.material])]))
      has_limit[query.pixel] = false;
  return has_limit;
}

/// How far a pixel's sum over its samples may be off: what it would change by if every other row of them,
/// every other column, or every other sample counted twice and the rest not at all, and what each is unsure
/// of.
double doubt(const Samples& samples, int row, int column) {
  const double expected = luminance(samples.sum(row, column));
  const std::vector<double>& weights = samples.lattice.filter.weights;
  double rows = 0, columns = 0, both = 0, unsure = 0;
  for (std::size_t j = 0; j < weights.size(); ++j)
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double weight = weights[j] * weights[i];
      if (!(weight > 0)) continue;
      const double part = weight * luminance(samples.at(row, column, i, j));
      unsure += std::pow(weight * samples.unsure(samples.place(row, column, i, j), expected), 2);
      rows += j % 2 == 0 ? part : -part;
      columns += i % 2 == 0 ? part : -part;
      both += (i + j) % 2 == 0 ? part : -part;
    }
  return std::sqrt(rows * rows + columns * columns + both * both + unsure);
}

/// Weights by which six samples along an axis, half as far apart, stand for one between the middle two of
/// them: of a Gaussian, and such that they keep its variance.
class Denser {
 public:
  static constexpr int kCount = 6;

  Denser(double sigma, double fine_sigma, double fine_spacing) {
    const double wanted = (sigma * sigma - fine_sigma * fine_sigma) / (fine_spacing * fine_spacing);
    double width2 = wanted;
    for (int step = 0; step < 8; ++step) width2 = std::max(width2 + wanted - set(width2), 0.1);
  }
  double operator[](int n) const { return weights_[n]; }

 private:
  /// @return their variance.
  double set(double width2) {
    double sum = 0, variance = 0;
    for (int n = 0; n < kCount; ++n) {
      const double x = n - 0.5 * (kCount - 1);
      weights_[n] = std::exp(-0.5 * x * x / width2);
      sum += weights_[n], variance += weights_[n] * x * x;
    }
    for (double& weight : weights_) weight /= sum;
    return variance / sum;
  }

  double weights_[kCount];
};

/// A pixel as a sum of samples, of which those that differ from their neighbours give way to denser ones.
class RefinedPixel {
 public:
  RefinedPixel(std::size_t pixel, const Samples& coarse)
      : pixel_(pixel),
        row_(static_cast<int>(pixel) / coarse.lattice.width),
        column_(static_cast<int>(pixel) % coarse.lattice.width),
        shown_(coarse.sum(row_, column_)) {
    const std::vector<double>& weights = coarse.lattice.filter.weights;
    for (const double down : weights)
      for (const double right : weights) weights_.push_back(down * right);
  }

  /// Parts with samples that change its luminance by `most` or more, if neighbours were right.
  /// @param fine the lattice twice as dense. @return whether it had any.
  bool split(const Samples& samples, const Lattice& fine, double most) {
    const std::size_t across = samples.lattice.filter.weights.size();
    const Denser along(samples.lattice.filter.sigma_pixels, fine.filter.sigma_pixels, 1.0 / fine.subpixels);
    const int last = 2 * static_cast<int>(across) - 1;
    std::vector<double> denser(4 * across * across, 0.0);
    bool any = false;
    for (std::size_t j = 0; j < across; ++j)
      for (std::size_t i = 0; i < across; ++i) {
        const double weight = weights_[j * across + i];
        if (!(weight > 0)) continue;
        if (!(weight * contrast(samples, i, j) > most)) {
          even_ += weight * samples.at(row_, column_, i, j);
          continue;
        }
        any = true;
        for (int y = 0; y < Denser::kCount; ++y)
          for (int x = 0; x < Denser::kCount; ++x) {
            const int down = std::clamp(2 * static_cast<int>(j) + y - 2, 0, last),
                      right = std::clamp(2 * static_cast<int>(i) + x - 2, 0, last);
            const std::size_t place =
                static_cast<std::size_t>(down) * 2 * across + static_cast<std::size_t>(right);
            denser[place] += weight * along[y] * along[x];
          }
      }
    weights_ = std::move(denser);
    return any;
  }

  /// Adds the samples that it needs.
  void choose(const Lattice& lattice, Lattice::Choice* chosen) const {
    const auto n = static_cast<std::size_t>(lattice.subpixels);
    each([&](std::size_t i, std::size_t j, double) {
      const int down = static_cast<int>(j / n) - lattice.margin,
                right = static_cast<int>(i / n) - lattice.margin;
      std::vector<bool>& cell = (*chosen)[lattice.cell(row_ + down, column_ + right)];
      cell.resize(n * n, false);
      cell[j % n * n + i % n] = true;
    });
  }

  /// @return by how much its luminance changed, and may be off for what its samples are not sure of.
  double look_at(const Samples& samples) {
    Eigen::Vector3d color = even_;
    each([&](std::size_t i, std::size_t j, double weight) {
      color += weight * samples.at(row_, column_, i, j);
    });
    double square = std::pow(luminance(color - shown_), 2);
    shown_ = color;
    each([&](std::size_t i, std::size_t j, double weight) {
      const std::size_t place = samples.place(row_, column_, i, j);
      square += std::pow(weight * samples.unsure(place, luminance(shown_)), 2);
    });
    return std::sqrt(square);
  }

  std::size_t pixel() const { return pixel_; }
  const Eigen::Vector3d& shown() const { return shown_; }

 private:
  template <typename Visit>
  void each(const Visit& visit) const {
    const auto across = static_cast<std::size_t>(std::lround(std::sqrt(weights_.size())));
    for (std::size_t j = 0; j < across; ++j)
      for (std::size_t i = 0; i < across; ++i)
        if (const double weight = weights_[j * across + i]; weight > 0) visit(i, j, weight);
  }

  /// The largest difference of luminance to a sample beside it that is there for this pixel.
  double contrast(const Samples& samples, std::size_t i, std::size_t j) const {
    const std::size_t across = samples.lattice.filter.weights.size();
    const double here = luminance(samples.at(row_, column_, i, j));
    double most = samples.unsure(samples.place(row_, column_, i, j), luminance(shown_));
    const auto look = [&](std::size_t x, std::size_t y) {
      if (x < across && y < across && weights_[y * across + x] > 0)  // -1 is larger
        most = std::max(most, std::abs(luminance(samples.at(row_, column_, x, y)) - here));
    };
    look(i - 1, j), look(i + 1, j), look(i, j - 1), look(i, j + 1);
    return most;
  }

  std::size_t pixel_;
  int row_, column_;
  Eigen::Vector3d even_ = Eigen::Vector3d::Zero(), shown_;  // of samples that stay; of all
  std::vector<double> weights_;                             // of those that it sees, row by row
};

}  // namespace

Refinement::Refinement(const BuiltJob& built) : built_(built) {
  const PixelSettings& pixels = built.scene().pixels();
  const std::vector<std::string>& channels = built.plan().channels;
  const bool wants_errors = std::find(channels.begin(), channels.end(), "error.Y") != channels.end();
  // One sample a pixel says nothing of its error.
  tells_doubts_ = built.sees_scene() && pixels.subpixels > 1 && (pixels.fits || wants_errors);
  const std::vector<PlannedEvaluator>& evaluators = built.plan().evaluators;
  if (tells_doubts_ && pixels.fits && !std::all_of(evaluators.begin(), evaluators.end(), has_no_limit))
    most_change_ = kChangeOfTolerance * std::sqrt(built.job().image.width / kWidth) *
                   built.job().accuracy.tolerance * std::sqrt(mean_square(built));
}

std::size_t Refinement::refine(TracedRows* rows, const std::vector<float>& densities) {
  if (!tells_doubts_) return 0;
  Asked asked;
  FilmRepairs repairs;  // the film counts them
  Samples samples{rows->lattice, sample_radiance_of(*rows, densities, &repairs), hidden_of(*rows, densities),
                  missed_of(*rows)};
  const std::vector<bool> has_limit = pixels_with_limit(built_, *rows);
  std::vector<RefinedPixel> doubtful;
  const auto width = static_cast<std::size_t>(rows->lattice.width);
  for (std::size_t pixel = 0; pixel < rows->fitted.size(); ++pixel) {
    if (rows->fitted[pixel]) continue;
    const double change =
        kChangeOfDoubt * doubt(samples, static_cast<int>(pixel / width), static_cast<int>(pixel % width));
    rows->doubt[pixel] = static_cast<float>(change);
    if (most_change_ > 0 && change > most_change_ && has_limit[pixel]) doubtful.emplace_back(pixel, samples);
  }
  refined_ += doubtful.size();
  PixelSettings pixels = built_.scene().pixels();
  pixels.fits = false;
  pixels.asks_hidden = true;
  for (const int finest = kFinestBy * pixels.subpixels; pixels.subpixels < finest;) {
    pixels.subpixels *= 2;
    const Lattice lattice = built_.scene().lattice(pixels);
    std::vector<RefinedPixel> uneven;
    for (RefinedPixel& pixel : doubtful)
      if (pixel.split(samples, lattice, kUnevenOfChange * most_change_)) uneven.push_back(std::move(pixel));
    doubtful = std::move(uneven);
    if (doubtful.empty()) break;
    Lattice::Choice chosen(lattice.cells(rows->row_count));
    for (const RefinedPixel& pixel : doubtful) pixel.choose(lattice, &chosen);
    samples = sample(built_, rows->first_row, rows->row_count, chosen, pixels,
                     std::max(kFewQueries, densities.size() / 16), &asked);
    std::vector<RefinedPixel> changed;
    for (RefinedPixel& pixel : doubtful) {
      const double change = pixel.look_at(samples);
      rows->fitted[pixel.pixel()] = 1;
      rows->doubt[pixel.pixel()] = static_cast<float>(kChangeOfHalf * change);
      rows->radiance[pixel.pixel()] = pixel.shown().cast<float>();
      if (change > most_change_) changed.push_back(std::move(pixel));
    }
    doubtful = std::move(changed);
  }
  dropped_ += asked.dropped;
  return asked.queries;
}

}  // namespace mica::host
