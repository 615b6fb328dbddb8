// A method of your own: brute force by a hundred points of the footprint. In the registry it answers wherever
// the library's methods do: run this program as `mica`, e.g. `new_method eval --ndf points --points 400 ...`.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "mica/mica.h"

namespace {

/// The mean of the intrinsic Gaussian over points of the footprint, at equal shares of its weight.
class Points : public mica::Method::Densities {
 public:
  Points(const mica::NormalMap& map, int points)
      : width_(map.width()),
        height_(map.height()),
        points_(points),
        normals_(2UL * map.width() * map.height()) {
    map.copy_normals(mica::Span<double>(normals_));
  }

  void evaluate(mica::Span<const mica::Query> queries, mica::Span<float> densities) const override {
    for (std::size_t n = 0; n < queries.size; ++n) densities[n] = static_cast<float>(density(queries[n]));
  }

 private:
  double density(const mica::Query& q) const {
    const double pi = 3.14159265358979323846, a = std::sqrt(q.cuu), b = q.cuv / a,
                 c = std::sqrt(q.cvv - b * b);
    double sum = 0;
    for (int n = 0; n < points_; ++n) {
      const double radius = std::sqrt(-2 * std::log((n + 0.5) / points_)), angle = 2.399963229728653 * n;
      const double x = radius * std::cos(angle), y = radius * std::sin(angle);
      const double* const normal = texel(q.u + a * x, q.v + b * x + c * y);
      const double ds = (normal[0] - q.s) / q.roughness, dt = (normal[1] - q.t) / q.roughness;
      sum += std::exp(-0.5 * (ds * ds + dt * dt)) / (2 * pi * q.roughness * q.roughness);
    }
    return sum / points_;
  }

  const double* texel(double u, double v) const {
    const auto i = static_cast<std::size_t>((u - std::floor(u)) * width_) % static_cast<std::size_t>(width_);
    const auto j =
        static_cast<std::size_t>((v - std::floor(v)) * height_) % static_cast<std::size_t>(height_);
    return &normals_[2 * (j * static_cast<std::size_t>(width_) + i)];
  }

  int width_, height_, points_;
  std::vector<double> normals_;
};

class PointsMethod : public mica::Method {
 public:
  std::string name() const override { return "points"; }
  std::string summary() const override { return "brute force by points of the footprint"; }
  std::vector<mica::MethodNumber> numbers() const override {
    return {{"points", "Points of a footprint", 100, 1, 1e6}};
  }
  std::unique_ptr<Densities> make(const mica::NormalMap& map,
                                  const std::vector<double>& numbers) const override {
    return std::make_unique<Points>(map, static_cast<int>(numbers[0]));
  }
};

}  // namespace

int main(int argc, char** argv) {
  try {
    mica::Methods methods;
    methods.add(std::make_shared<PointsMethod>());
    if (argc > 1) return mica::run_program(argc, argv, methods);

    const mica::NormalMap map = mica::NormalMap::generate("spectrum", {{"resolution", 256}});
    const mica::Evaluator points(mica::Device(), map, "points", {{"points", 4000}}, methods);
    mica::Query query;
    query.cuu = query.cvv = std::pow(8.0 / map.width(), 2);
    query.roughness = 0.05;
    std::printf("D = %.4g by %s\n", points.evaluate(mica::Span<const mica::Query>(&query, 1))[0],
                points.method().c_str());
    return 0;
  } catch (const mica::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
