#include "host/render/refinement.h"

#include <algorithm>
#include <cmath>

#include "host/base/random.h"
#include "host/render/film.h"
#include "host/render/gather_light.h"
#include "host/render/luminance.h"

namespace mica::host {
namespace {

constexpr std::uint64_t kLooks = 0x6c6f6f6b;  // a stream of random numbers
constexpr int kLooksAlong = 16;               // rows that are looked at, and pixels of each
constexpr int kLookSubpixels = 2;             // of those pixels
constexpr std::size_t kFewQueries = 1024;
constexpr int kFinestBy = 4;  // along each axis
/// Of the root mean square of a picture and its tolerance: a change of a pixel that may stay, in a picture
/// 160 pixels wide. The pixels that need samples lie along lines: the wider a picture is the fewer they are.
constexpr double kChangeOfTolerance = 4, kWidth = 160;
/// How much less than their doubt pixels change: a third of it, root mean square, where it was measured.
constexpr double kChangeOfDoubt = 1.0 / 3;
/// Of a change by samples twice as dense: how much more four times as dense ones would change.
constexpr double kChangeOfHalf = 0.5;
constexpr Lattice::Rings kNear{0, 1};  // what Scene::sample samples

using Colors = std::vector<Eigen::Vector3d>;

struct Samples {
  Lattice lattice;
  Colors radiance;

  /// What a pixel sees of some rings about it.
  Eigen::Vector3d sum(int row, int column, const Lattice::Rings& rings) const {
    Eigen::Vector3d color = Eigen::Vector3d::Zero();
    lattice.sum(row, column, rings,
                [&](std::size_t sample, double weight) { color += weight * radiance[sample]; });
    return color;
  }
};

/// Densities of all queries of rows, few at a time: the device has a block of rows in flight besides. Tints
/// the weights of glints.
std::vector<float> densities_of(const BuiltJob& built, TracedRows* rows, std::size_t queries_at_a_time) {
  std::vector<float> densities;
  for (std::size_t first = 0; first < rows->queries.size(); first += queries_at_a_time) {
    const std::size_t count = std::min(queries_at_a_time, rows->queries.size() - first);
    const auto begin = rows->queries.begin() + static_cast<std::ptrdiff_t>(first);
    TracedRows some;
    some.queries.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
    PendingBlock block(std::move(some), built);
    const std::vector<float> answers = block.wait();
    densities.insert(densities.end(), answers.begin(), answers.end());
    std::copy(block.rows().queries.begin(), block.rows().queries.end(), begin);
  }
  return densities;
}

Samples sample(const BuiltJob& built, int first_row, int row_count, const std::vector<bool>& which,
               const PixelSettings& pixels, std::size_t queries_at_a_time, std::size_t* queries) {
  TracedRows rows = built.scene().sample(first_row, row_count, which, pixels);
  *queries += rows.queries.size() + add_lit_brdfs(built, &rows);
  const std::vector<float> densities = densities_of(built, &rows, queries_at_a_time);
  FilmRepairs repairs;  // what is black for that reason was so before
  return {rows.lattice, sample_radiance_of(rows, densities, &repairs)};
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
  pixels.fits = pixels.turns = false;
  pixels.filter = PixelFilter({});  // of the pixel alone
  pixels.subpixels = kLookSubpixels;
  double sum = 0;
  std::size_t queries = 0;
  for (int n = 0; n < kLooksAlong; ++n) {
    std::vector<bool> which(static_cast<std::size_t>(image.width));
    std::vector<int> columns;
    for (int m = 0; m < kLooksAlong; ++m) {
      columns.push_back(place(m, image.width, (n + 1) * kLooksAlong + m));
      which[static_cast<std::size_t>(columns.back())] = true;
    }
    const Samples samples = sample(built, place(n, image.height, n), 1, which, pixels, kFewQueries, &queries);
    for (const int column : columns)
      sum += std::pow(luminance(samples.sum(0, column, kNear)), 2) / (kLooksAlong * kLooksAlong);
  }
  return sum;
}

/// How far a pixel's sum over its samples may be off: what it would change by if every other row of them,
/// every other column, or every other sample counted twice and the rest not at all.
double doubt(const Samples& samples, int row, int column) {
  const Lattice& lattice = samples.lattice;
  const auto n = static_cast<std::size_t>(lattice.subpixels), across = lattice.filter.weights.size();
  double rows = 0, columns = 0, both = 0;
  for (std::size_t j = 0; j < across; ++j)
    for (std::size_t i = 0; i < across; ++i) {
      const double weight = lattice.filter.weights[j] * lattice.filter.weights[i];
      if (!(weight > 0)) continue;
      const int down = static_cast<int>(j / n) - lattice.margin,
                right = static_cast<int>(i / n) - lattice.margin;
      const std::size_t first = lattice.first_sample[lattice.cell(row + down, column + right)];
      const double part = weight * luminance(samples.radiance[first + j % n * n + i % n]);
      rows += j % 2 == 0 ? part : -part;
      columns += i % 2 == 0 ? part : -part;
      both += (i + j) % 2 == 0 ? part : -part;
    }
  return std::sqrt(rows * rows + columns * columns + both * both);
}

}  // namespace

Refinement::Refinement(const BuiltJob& built) : built_(built) {
  const PixelSettings& pixels = built.scene().pixels();
  const std::vector<std::string>& channels = built.plan().channels;
  const bool wants_errors = std::find(channels.begin(), channels.end(), "error.Y") != channels.end();
  // One sample a pixel says nothing of its error.
  tells_doubts_ = built.sees_scene() && pixels.subpixels > 1 && (pixels.fits || wants_errors);
  if (tells_doubts_ && pixels.fits)
    most_change_ = kChangeOfTolerance * std::sqrt(built.job().image.width / kWidth) *
                   built.job().accuracy.tolerance * std::sqrt(mean_square(built));
}

std::size_t Refinement::refine(TracedRows* rows, const std::vector<float>& densities) {
  std::size_t queries = 0;
  if (!tells_doubts_) return queries;
  FilmRepairs repairs;  // the film counts them
  const Samples coarse{rows->lattice, sample_radiance_of(*rows, densities, &repairs)};
  const int width = rows->lattice.width;
  std::vector<bool> doubtful(rows->fitted.size());
  const auto each_doubtful = [&](const auto& visit) {
    for (std::size_t pixel = 0; pixel < doubtful.size(); ++pixel)
      if (doubtful[pixel]) visit(pixel, static_cast<int>(pixel) / width, static_cast<int>(pixel) % width);
  };
  for (std::size_t pixel = 0; pixel < doubtful.size(); ++pixel) doubtful[pixel] = !rows->fitted[pixel];
  std::size_t count = 0;
  each_doubtful([&](std::size_t pixel, int row, int column) {
    const double change = kChangeOfDoubt * doubt(coarse, row, column);
    rows->doubt[pixel] = static_cast<float>(change);
    doubtful[pixel] = most_change_ > 0 && change > most_change_;
    count += doubtful[pixel] ? 1 : 0;
  });
  if (count == 0) return queries;
  refined_ += count;
  std::vector<Eigen::Vector3d> shown(doubtful.size());
  each_doubtful([&](std::size_t pixel, int row, int column) {
    shown[pixel] = coarse.sum(row, column, rows->lattice.all());
  });
  PixelSettings pixels = built_.scene().pixels();
  pixels.fits = false;
  const int finest = kFinestBy * pixels.subpixels;
  while (pixels.subpixels < finest && count > 0) {
    pixels.subpixels *= 2;
    const Samples fine = sample(built_, rows->first_row, rows->row_count, doubtful, pixels,
                                std::max(kFewQueries, densities.size() / 16), &queries);
    count = 0;
    each_doubtful([&](std::size_t pixel, int row, int column) {
      // What is further away has hardly any weight, and stays.
      const Eigen::Vector3d color =
          fine.sum(row, column, kNear) + coarse.sum(row, column, {kNear.farthest + 1, rows->lattice.margin});
      const double change = std::abs(luminance(color - shown[pixel]));
      rows->doubt[pixel] = static_cast<float>(kChangeOfHalf * change);
      doubtful[pixel] = change > most_change_;
      count += doubtful[pixel] ? 1 : 0;
      shown[pixel] = color;
      rows->fitted[pixel] = 1;
      rows->radiance[pixel] = color.cast<float>();
    });
  }
  return queries;
}

}  // namespace mica::host
