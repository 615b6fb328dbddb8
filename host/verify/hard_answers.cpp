#include "host/verify/hard_answers.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>

#include "host/base/constants.h"
#include "host/base/interrupt.h"
#include "host/base/random.h"
#include "host/base/stopwatch.h"
#include "host/base/symmetric_matrix.h"
#include "host/methods/patch_brdf.h"
#include "host/surface/disk.h"
#include "host/surface/interpolate.h"
#include "host/surface/texel_footprint.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr int kSide = 24;  // texels: maps are small, so that wide footprints cost little
constexpr double kMostTexels = 1000, kMostTexelsOfBrdf = 30;  // standard deviations of footprints
constexpr std::uint64_t kBatch = 4096;
constexpr std::uint64_t kBrdfShare = 5, kOracleShare = 200;  // of the answers: they are slow

/// QuestionRandom numbers of one question.
class QuestionRandom {
 public:
  explicit QuestionRandom(std::uint64_t question) : question_(question) {}
  double uniform(double low, double high) {
    return low + (high - low) * random_unit(0x4a5d, count_++, question_);
  }
  double log_uniform(double low, double high) { return low * std::pow(high / low, uniform(0, 1)); }
  int among(int count) { return static_cast<int>(uniform(0, count)); }
  Eigen::Vector2d direction() {
    const double angle = uniform(0, 2 * kPi);
    return {std::cos(angle), std::sin(angle)};
  }
  Eigen::Vector2d normal() { return std::sqrt(-2 * std::log1p(-uniform(0, 1))) * direction(); }

 private:
  std::uint64_t question_, count_ = 0;
};

Surface map_by(const std::function<Eigen::Vector2d(int i, int j)>& normal) {
  std::vector<Eigen::Vector2d> normals;
  for (int n = 0; n < kSide * kSide; ++n) normals.push_back(normal(n % kSide, n / kSide));
  return Surface(kSide, kSide, Interpolation::bilinear, std::move(normals));
}

template <typename Source>
Surface hard_map(const Source& source, Interpolation interpolation) {
  return make_surface({"hard questions", source, interpolation}, nullptr);
}

std::vector<Surface> hard_surfaces() {
  constexpr double steep = 1e3, a_turn = 2 * kPi / kSide;
  std::vector<Surface> surfaces = {
      map_by([](int, int) { return Eigen::Vector2d(0.0980392, -0.0588235); }), map_by([](int i, int j) {
        const double angle = a_turn * i + 0.7 * std::sin(a_turn * j);
        return Eigen::Vector2d((1 - 1e-6) * std::cos(angle), (1 - 1e-6) * std::sin(angle));
      }),
      map_by([](int i, int j) {
        return Eigen::Vector2d(((i + j) % 2 ? steep : -steep) / std::sqrt(1 + steep * steep), 0);
      }),
      map_by([](int i, int j) {
        return Eigen::Vector2d(0.3 * std::cos(3 * a_turn * i), 0.2 * std::cos(2 * a_turn * j));
      }),
      Surface(1, 1, Interpolation::bilinear, {Eigen::Vector2d(0.2, 0.1)})};
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    surfaces.push_back(hard_map(FlakesSurface{kSide, 5, 0.3, 5}, interpolation));
    surfaces.push_back(hard_map(SpectrumSurface{kSide, 5, 2, 3}, interpolation));
    surfaces.push_back(hard_map(SpectrumSurface{kSide, 0.1, 6, 4}, interpolation));
  }
  return surfaces;
}

/// One in 32 is wide: those cost as much as all others.
Footprint footprint_of(const Surface& surface, double most_texels, QuestionRandom* random) {
  constexpr double least_texels = 0.01, narrow_texels = 3, thinnest = 1.5e-3;
  constexpr int one_in = 32;
  const bool is_wide = random->among(one_in) == 0;
  const double major = is_wide ? random->log_uniform(narrow_texels, most_texels)
                               : random->log_uniform(least_texels, narrow_texels);
  const double aspect =
      random->among(2) ? random->log_uniform(1, 1400) : 1;  // correlation 1 - 1e-6 at 45 degrees
  const double angle = random->among(2) ? kPi / 4 : random->uniform(0, kPi);
  return make_footprint(surface, {random->uniform(-2, 2), random->uniform(-2, 2)}, major,
                        std::max(major / aspect, std::min(thinnest, major)), angle);
}

Eigen::Vector2d half_vector_of(const Surface& surface, const Query& query, QuestionRandom* random) {
  if (random->among(4) == 0) return std::sqrt(random->uniform(0, 1)) * random->direction();
  if (random->among(8) == 0) return random->direction();
  const Eigen::Vector2d uv =
      query.footprint.mean_uv + cholesky_factor(query.footprint.cov_uv) * random->normal();
  const Eigen::Vector2d wrapped = uv - uv.array().floor().matrix();
  const Eigen::Vector2d normal =
      normal_at(surface, wrapped.cwiseProduct(Eigen::Vector2d(surface.width(), surface.height())));
  constexpr double far_tail =
      40;  // standard deviations: exp(-800) is 0 in single precision, and nearly in double
  const double distance = random->among(2) ? random->uniform(0, 4) : random->uniform(4, far_tail);
  const Eigen::Vector2d half = normal + distance * query.roughness * random->direction();
  return half.cwiseMax(-1).cwiseMin(1);
}

/// Half vectors that turn by up to the disk's radius over the footprint, and a lobe that is a needle.
void add_first_order(const Surface& surface, QuestionRandom* random, Query* query) {
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(random->uniform(0, kPi)).toRotationMatrix();
  const Eigen::Vector2d sigmas(query->roughness, random->log_uniform(1e-4, 1));
  Eigen::Matrix2d lobe = rotation * sigmas.cwiseAbs2().asDiagonal() * rotation.transpose();
  lobe(1, 0) = lobe(0, 1);
  query->lobe_cov = lobe;
  if (random->among(4) == 0) return;
  Eigen::Matrix2d turn;
  turn << random->uniform(-1, 1), random->uniform(-1, 1), random->uniform(-1, 1), random->uniform(-1, 1);
  turn = turn * Eigen::Vector2d(surface.width(), surface.height()).asDiagonal();
  const double most = std::sqrt((turn * query->footprint.cov_uv * turn.transpose()).trace());
  query->half_vector_turn = random->log_uniform(1e-5, 1) / most * turn;
}

Query query_of(const Surface& surface, double most_texels, bool first_order, std::uint64_t question) {
  QuestionRandom random(question);
  Query query;
  query.footprint = footprint_of(surface, most_texels, &random);
  query.roughness = random.log_uniform(1e-4, 1);
  query.half_vector = half_vector_of(surface, query, &random);
  if (first_order && random.among(2)) add_first_order(surface, &random, &query);
  return query;
}

Eigen::Vector3d random_direction(QuestionRandom* random) {
  const double cosine = random->among(2) ? random->log_uniform(1e-6, 1) : random->uniform(0, 1);
  const Eigen::Vector2d side = std::sqrt(1 - cosine * cosine) * random->direction();
  return {side.x(), side.y(), cosine};
}

bool is_right(double value) {
  return std::isfinite(value) && value >= 0;
}

/// Counts the answers to one kind of question.
class AnswerCount {
 public:
  explicit AnswerCount(HardAnswers* answers) : answers_(answers) {}

  void add(bool right, const std::string& found, const Query& query) {
    ++(right ? answers_->answered : answers_->wrong);
    if (right || !answers_->fault.empty()) return;
    const Eigen::Matrix2d& cov = query.footprint.cov_uv;
    answers_->fault =
        fmt::format("{} at uv ({}, {}), covariance {}, {}, {}, half vector ({}, {}), roughness {}{}", found,
                    query.footprint.mean_uv.x(), query.footprint.mean_uv.y(), cov(0, 0), cov(0, 1), cov(1, 1),
                    query.half_vector.x(), query.half_vector.y(), query.roughness,
                    has_first_order(query) ? ", turned or with a lobe" : "");
  }
  /// What has an answer without its turn may be refused for that.
  void refuse(const std::string& problem, const Query& query) {
    if (query.half_vector_turn.isZero(0))
      add(false, problem, query);
    else
      ++answers_->refused;
  }
  /// Asks for a batch; what it loses is all wrong.
  template <typename Ask>
  void ask(std::size_t questions, const Query& first, const Ask& ask) {
    try {
      ask();
    } catch (const Error& error) {
      answers_->wrong += questions - 1;
      add(false, error.what(), first);
    }
  }

 private:
  HardAnswers* answers_;
};

/// The questions that the method takes; the others are counted, see AnswerCount::refuse.
std::vector<Query> taken(const Method& method, const Surface& surface, double most_texels,
                         std::uint64_t first, std::uint64_t count, AnswerCount* answers) {
  std::vector<Query> queries;
  for (std::uint64_t n = 0; n < count; ++n) {
    const Query query = query_of(surface, most_texels, method.traits().first_order, first + n);
    const std::string problem = method.query_problem(query, &surface);
    if (problem.empty())
      queries.push_back(query);
    else
      answers->refuse(problem, query);
  }
  return queries;
}

void ask_densities(const Method& method, Device* device, const Surface& surface, std::uint64_t first,
                   std::uint64_t count, HardAnswers* answers) {
  const std::unique_ptr<Evaluator> evaluator = method.make(device, &surface, *method.settings());
  AnswerCount answered(answers);
  bool calibrated = false;
  for (std::uint64_t done = 0; done < count; done += kBatch) {
    check_interrupt();
    const std::vector<Query> queries =
        taken(method, surface, kMostTexels, first + done, std::min(kBatch, count - done), &answered);
    if (queries.empty()) continue;
    answered.ask(queries.size(), queries.front(), [&] {
      if (!calibrated)
        evaluator->calibrate(
            queries.size(), [&](std::size_t n) { return queries[n]; }, 1);
      calibrated = true;
      const std::vector<float> densities = evaluator->evaluate(queries);
      for (std::size_t n = 0; n < queries.size(); ++n)
        answered.add(is_right(densities[n]), fmt::format("D = {}", densities[n]), queries[n]);
    });
  }
  answers->replaced += evaluator->replaced();
}

void ask_hard_brdf(const Method& method, Device* device, const Surface& surface, std::uint64_t first,
                   std::uint64_t count, HardAnswers* answers) {
  const std::unique_ptr<PatchBrdf> brdf = method.make_brdf(device, &surface, *method.settings());
  AnswerCount answered(answers);
  for (std::uint64_t done = 0; done < count; done += kBatch) {
    check_interrupt();
    const std::vector<Query> queries =
        taken(method, surface, kMostTexelsOfBrdf, first + done, std::min(kBatch, count - done), &answered);
    if (queries.empty()) continue;
    std::vector<BrdfQuery> values;
    std::vector<ViewQuery> views;
    std::vector<SampleQuery> draws;
    for (const Query& query : queries) {
      QuestionRandom random(~(first + done + values.size()));
      values.push_back(
          {query.footprint, random_direction(&random), random_direction(&random), query.roughness});
      views.push_back({query.footprint, values.back().view, query.roughness});
      draws.push_back({views.back(), first + done + draws.size()});
    }
    answered.ask(3 * queries.size(), queries.front(), [&] {
      const std::vector<BrdfValue> found = brdf->evaluate(values);
      const std::vector<Albedo> albedos = brdf->energy(views);
      const std::vector<BrdfSample> samples = brdf->sample(draws);
      for (std::size_t n = 0; n < queries.size(); ++n) {
        const BrdfValue& v = found[n];
        const Albedo& a = albedos[n];
        const BrdfSample& s = samples[n];
        answered.add(is_right(v.single) && is_right(v.multiple) && is_right(v.pdf),
                     fmt::format("value {} + {}, pdf {}", v.single, v.multiple, v.pdf), queries[n]);
        answered.add(is_right(a.single) && is_right(a.lost),
                     fmt::format("energy {}, lost {}", a.single, a.lost), queries[n]);
        answered.add(is_right(s.pdf) && is_right(s.weight_single) && is_right(s.weight_multiple) &&
                         s.light.allFinite(),
                     fmt::format("a draw of pdf {}", s.pdf), queries[n]);
      }
    });
  }
  answers->replaced += brdf->replaced();
}

}  // namespace

std::vector<HardAnswers> ask_hard_questions(Device& device, std::uint64_t answers, std::uint64_t first,
                                            const MethodRegistry& methods) {
  const std::vector<Surface> surfaces = hard_surfaces();
  std::vector<HardAnswers> all;
  for (const auto& method : methods.all()) {
    const MethodTraits traits = method->traits();
    std::vector<const Surface*> own;
    for (const Surface& surface : surfaces)
      if (method->takes(surface.interpolation())) own.push_back(&surface);
    for (const bool of_brdf : {false, true}) {
      if (of_brdf ? !traits.brdf : !traits.densities) continue;
      const Stopwatch clock;
      const std::uint64_t share = of_brdf ? kBrdfShare : traits.device ? 1 : kOracleShare;
      const std::uint64_t each = answers / share / own.size() + 1;
      HardAnswers found;
      found.method = method->name() + (of_brdf ? ", BRDF" : "");
      for (std::size_t n = 0; n < own.size(); ++n) {
        if (of_brdf)
          ask_hard_brdf(*method, &device, *own[n], first + n * each, each / 3 + 1, &found);
        else
          ask_densities(*method, &device, *own[n], first + n * each, each, &found);
      }
      found.seconds = clock.seconds();
      all.push_back(found);
    }
  }
  return all;
}

}  // namespace mica::host
