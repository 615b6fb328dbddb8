#include "host/verify/hard_cases.h"

#include <cmath>
#include <limits>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/surface/texel_footprint.h"
#include "host/verify/accuracy.h"

namespace mica::host {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double random(std::uint64_t n, std::uint64_t stream) {
  return random_unit(0x4a4d, stream, n);
}

Surface spectrum(Interpolation interpolation) {
  return make_surface({"hard case", SpectrumSurface{128, 0.15, 8, 3}, interpolation}, nullptr);
}
Surface noise() {
  return spectrum(Interpolation::bilinear);
}
Surface flakes(Interpolation interpolation) {
  return make_surface({"hard case", FlakesSurface{128, 12, 0.2, 5}, interpolation}, nullptr);
}

/// @param normal of the texel with its centre at (x, y) in [0, 1)^2.
Surface formula(int width, int height, Interpolation interpolation,
                const std::function<Eigen::Vector2d(double x, double y)>& normal) {
  std::vector<Eigen::Vector2d> normals;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) normals.push_back(normal((i + 0.5) / width, (j + 0.5) / height));
  return Surface(width, height, interpolation, std::move(normals));
}
Surface bilinear(const std::function<Eigen::Vector2d(double x, double y)>& normal) {
  return formula(128, 128, Interpolation::bilinear, normal);
}
/// Normals all around, at a distance from the rim.
Surface around_the_rim(double distance) {
  return bilinear([distance](double x, double y) {
    const double angle = 2 * kPi * x + 0.7 * std::sin(2 * kPi * y), radius = 1 - distance;
    return Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
  });
}
/// One texel is `broken`.
Surface noise_with(const Eigen::Vector2d& broken) {
  std::vector<Eigen::Vector2d> normals = noise().normals();
  normals[777] = broken;
  return Surface(128, 128, Interpolation::bilinear, std::move(normals));
}
/// As 8 bits a channel hold it.
Surface quantised() {
  std::vector<Eigen::Vector2d> normals = noise().normals();
  for (Eigen::Vector2d& n : normals) n = ((n.array() + 1) * 127.5).round() / 127.5 - 1;
  return Surface(128, 128, Interpolation::bilinear, std::move(normals));
}
/// Steps between opposite normals: Catmull-Rom overshoots the rim.
Surface steps() {
  return formula(32, 32, Interpolation::bicubic, [](double x, double y) {
    return Eigen::Vector2d(std::fmod(4 * x, 1.0) < 0.5 ? 0.93 : -0.93, 0.3 * std::sin(2 * kPi * y));
  });
}

using Question = std::function<Query(const Surface&, std::uint64_t)>;

/// Standard deviations log-uniform in a range, texels, and the ratio of the axes likewise.
struct Range {
  double low, high;
  double at(double share) const { return low * std::pow(high / low, share); }
};
Question anywhere(Range sigma_texels, Range roughness, Range aspect = {1, 4}) {
  return [=](const Surface& surface, std::uint64_t n) {
    const double major = sigma_texels.at(random(n, 0));
    return Query{make_footprint(surface, {random(n, 1), random(n, 2)}, major, major / aspect.at(random(n, 3)),
                                kPi * random(n, 4)),
                 Eigen::Vector2d::Zero(), roughness.at(random(n, 5))};
  };
}
constexpr Range kSmall{0.3, 3}, kUsual{3e-3, 0.1};

Question at(const std::function<Eigen::Vector2d(const Surface&, std::uint64_t)>& mean_uv,
            double sigma_texels) {
  return [=](const Surface& surface, std::uint64_t n) {
    return Query{
        make_footprint(surface, mean_uv(surface, n), sigma_texels, 0.6 * sigma_texels, kPi * random(n, 4)),
        Eigen::Vector2d::Zero(), kUsual.at(random(n, 5))};
  };
}

/// A usual question with something changed.
Question changed(const std::function<void(Query*, std::uint64_t n)>& change) {
  const Question usual = anywhere(kSmall, kUsual);
  return [=](const Surface& surface, std::uint64_t n) {
    Query query = usual(surface, n);
    change(&query, n);
    return query;
  };
}

/// On lines of the grid of leaves, tiles and blocks, and a hair beside them.
Eigen::Vector2d on_a_border(const Surface& surface, std::uint64_t n) {
  constexpr double sizes[] = {4, 16, 64, 0.5};
  constexpr double beside[] = {0, 1e-9, -1e-9, 0.5};
  const auto line = [&](std::uint64_t stream, int texels) {
    const double size = sizes[static_cast<int>(4 * random(n, stream))];
    return (size * std::floor(random(n, stream + 1) * texels / size) + beside[n % 4]) / texels;
  };
  return {line(10, surface.width()), line(12, surface.height())};
}
Eigen::Vector2d on_the_wrap(const Surface&, std::uint64_t n) {
  constexpr double places[] = {0, 1, -1e-9, 1 - 1e-9, -3};
  return {places[n % 5], n % 2 ? random(n, 10) : places[n / 2 % 5]};
}
Eigen::Vector2d far_away(const Surface&, std::uint64_t n) {
  return {1e7 * (2 * random(n, 10) - 1), -1e7 + random(n, 11)};
}

Eigen::Vector2d direction(std::uint64_t n) {
  const double angle = 2 * kPi * random(n, 20);
  return {std::cos(angle), std::sin(angle)};
}
/// In the corners between the disk and its square.
Eigen::Vector2d corner(std::uint64_t n) {
  const Eigen::Vector2d first(0.72 + 0.28 * random(n, 21), 0.72 + 0.28 * random(n, 22));
  return {n % 2 ? first.x() : -first.x(), n / 2 % 2 ? first.y() : -first.y()};
}

std::vector<HardCase> questions_about_footprints() {
  return {{"roughness 1e-5", "normals must be told apart at 1e-9, and a lobe is 1e9 high", noise,
           anywhere({0.3, 2}, {1e-5, 1.0001e-5})},
          {"roughness 1", "a lobe is as wide as the disk: nothing is culled, half of it lies off the disk",
           noise, anywhere(kSmall, {0.5, 1})},
          {"footprint 0.01 texel", "lies inside one triangle or on its edge", noise,
           anywhere({0.01, 0.02}, kUsual)},
          {"footprint 1e-3 texel", "the smallest that is taken", noise,
           anywhere({1.001e-3, 1.01e-3}, kUsual, {1, 1.0001})},
          {"footprint 1e6 texels", "covers the map thousands of times in each direction",
           [] {
             return make_surface({"hard case", SpectrumSurface{32, 0.15, 4, 3}, Interpolation::bilinear},
                                 nullptr);
           },
           anywhere({3e5, 9.9e5}, {0.01, 0.1}, {1, 2})},
          {"condition number 1e6", "a thousand times longer than wide, turned: a line through many periods",
           noise, anywhere({100, 200}, {0.01, 0.1}, {999, 1000})},
          {"condition number 1e6, small", "a thousand times longer than wide, inside a few texels", noise,
           anywhere({1.1, 4}, {0.01, 0.1}, {999, 1000})},
          {"on borders of tiles", "the mean lies on a line of the grid, or a hair beside it", noise,
           at(on_a_border, 1)},
          {"across the wrap", "the footprint sees the map's opposite edges", noise, at(on_the_wrap, 2)},
          {"uv of 1e7", "a float holds no fraction of a texel there", noise, at(far_away, 1)}};
}

std::vector<HardCase> questions_about_maps() {
  const Question usual = anywhere(kSmall, kUsual), sharp = anywhere(kSmall, {1e-3, 1.01e-3});
  std::vector<HardCase> cases = {
      {"flat map", "every triangle has no area on the disk: one spike",
       [] { return bilinear([](double, double) { return Eigen::Vector2d(0.1, -0.05); }); }, sharp},
      {"constant texels", "density jumps between neighbours", [] { return flakes(Interpolation::nearest); },
       usual},
      {"flakes, interpolated", "zero-area triangles inside flakes, steep and mirrored ones between",
       [] { return flakes(Interpolation::bilinear); }, usual},
      {"rank-1 map", "a ramp: normals lie on a line, with a step at the wrap",
       [] { return bilinear([](double x, double) { return Eigen::Vector2d(0.8 * x - 0.4, 0.1); }); }, usual},
      {"folded map", "the Jacobian vanishes along lines: densities rise to caustics",
       [] {
         return bilinear([](double x, double y) {
           return Eigen::Vector2d(0.3 * std::cos(6 * kPi * x), 0.2 * std::cos(4 * kPi * y));
         });
       },
       sharp},
      {"normals on the rim", "1e-6 from it: slopes above 700", [] { return around_the_rim(1e-6); }, usual},
      {"slopes of 1e3", "neighbours look in opposite directions at grazing angles",
       [] {
         return bilinear([](double x, double y) {
           const double slope = (static_cast<int>(128 * x) + static_cast<int>(128 * y)) % 2 ? 1e3 : -1e3;
           return Eigen::Vector2d(slope / std::sqrt(1 + slope * slope), 0);
         });
       },
       usual},
      {"bicubic steps", "Catmull-Rom overshoots the rim of the disk", steps, usual},
      {"8-bit map", "normals in steps of 1/127: many triangles have no area", quantised, sharp},
      {"map of 1 x 1", "a period smaller than every block, tile and leaf",
       [] { return Surface(1, 1, Interpolation::bilinear, {Eigen::Vector2d(0.2, 0.1)}); }, usual},
      {"map of 3 x 5", "periods that divide nothing",
       [] {
         return formula(3, 5, Interpolation::bilinear, [](double x, double y) {
           return Eigen::Vector2d(0.3 * std::sin(2 * kPi * x), 0.2 * std::cos(2 * kPi * y));
         });
       },
       usual},
      {"NaN texel", "must not spread",
       [] {
         return noise_with({kNaN, 0});
       },
       usual, false, true},
      {"infinite texel", "must not spread",
       [] {
         return noise_with({0, kInfinity});
       },
       usual, false, true},
      {"normal off the disk", "has no third component",
       [] {
         return noise_with({0.8, 0.7});
       },
       usual, false, true}};
  for (HardCase& hard_case : cases) hard_case.of_the_map = true;
  return cases;
}

std::vector<HardCase> questions_about_half_vectors() {
  return {
      {"half vectors off the disk", "only what the roughness pushes there has a density",
       [] { return around_the_rim(0.02); },
       changed([](Query* q, std::uint64_t n) { q->half_vector = corner(n), q->roughness = 0.1; }), true},
      {"grazing half vectors", "on the rim, to a float's last digit", [] { return around_the_rim(1e-4); },
       changed([](Query* q, std::uint64_t n) { q->half_vector = (1 - 1e-7 * random(n, 23)) * direction(n); }),
       true},
      {"half vectors beyond the square", "no direction has them", noise,
       changed([](Query* q, std::uint64_t n) { q->half_vector = (1.5 + random(n, 23)) * direction(n); }),
       true, true},
      {"NaN and infinite queries", "must not be answered", noise, changed([](Query* q, std::uint64_t n) {
         const double bad = n % 2 ? kNaN : kInfinity;
         switch (n / 2 % 4) {
           case 0:
             q->half_vector.x() = bad;
             break;
           case 1:
             q->footprint.mean_uv.y() = bad;
             break;
           case 2:
             q->footprint.cov_uv(0, 0) = bad;
             break;
           default:
             q->roughness = bad;
         }
       }),
       true, true},
      {"denormal covariances", "their determinant is zero", noise, changed([](Query* q, std::uint64_t n) {
         q->footprint.cov_uv = Eigen::Matrix2d::Identity() * (n % 2 ? 4.9e-324 : 1e-310);
         q->half_vector = random(n, 23) * direction(n);
       }),
       true},
      {"degenerate covariances", "a line, or a minus sign that rounding left", noise,
       changed([](Query* q, std::uint64_t n) {
         q->footprint.cov_uv << 1e-4, 1e-4, 1e-4, n % 2 ? 1e-4 : 1e-4 * (1 - 1e-15);
         q->half_vector = random(n, 23) * direction(n);
       }),
       true}};
}

}  // namespace

const std::vector<HardCase>& hard_cases() {
  static const std::vector<HardCase> cases = [] {
    std::vector<HardCase> all = questions_about_footprints();
    for (const auto& more : {questions_about_maps(), questions_about_half_vectors()})
      all.insert(all.end(), more.begin(), more.end());
    return all;
  }();
  return cases;
}

std::vector<Query> probe_of(const HardCase& hard_case, const Surface& surface, std::uint64_t n,
                            int half_vectors) {
  if (!hard_case.own_half_vectors) {
    const Query query = hard_case.question(surface, n);
    return probe(surface, query.footprint, query.roughness, half_vectors, n);
  }
  std::vector<Query> queries;
  const Footprint footprint = hard_case.question(surface, n).footprint;
  for (int k = 0; k < half_vectors; ++k) {
    queries.push_back(hard_case.question(surface, n * static_cast<std::uint64_t>(half_vectors) + k));
    if (!hard_case.must_be_refused) queries.back().footprint = footprint;
  }
  return queries;
}

}  // namespace mica::host
