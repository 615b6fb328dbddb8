#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/methods/auto/candidate.h"
#include "host/methods/evaluator.h"
#include "host/surface/surface.h"

namespace mica::host {

class PyramidEvaluator;
class PyramidStore;

QueryClass class_of(const Query& query, int map_width, int map_height);

/// Queries of a job that calibration may look at.
struct CalibrationSample {
  std::vector<Query> queries;                ///< of every class in random order
  std::map<QueryClass, double> counts = {};  ///< of all the job's queries; of other classes it has many
};

/// Up to `each` queries of every class among queries 0 to count - 1: those whose numbers hash lowest.
/// @param scale how many queries of the job each of these stands for.
CalibrationSample calibration_sample(std::size_t count, std::size_t each, int map_width, int map_height,
                                     const std::function<Query(std::size_t)>& query, double scale = 1);

/// `auto`: for each class of a job's queries the cheapest evaluator that keeps a tolerance. `triangles` to
/// that tolerance promise it; pyramids and mixtures are taken where a sample of the job's queries, compared
/// with exact triangles, shows at 95% confidence that they keep it, too. To look costs at most a twentieth of
/// what the job's queries do by triangles, and what cannot be won is not looked at. What is cheapest is told
/// by counting elements, not by a clock: the same queries get the same answers.
class AutoEvaluator : public Evaluator {
 public:
  /// @param tolerance relative L2 over a class's queries, kLeastTolerance or more. `device` and `surface`
  /// must outlive this. Throws UsageError for a smaller tolerance.
  /// @param looking_seconds of a core that the expected densities of a class may take, for more than 16.
  AutoEvaluator(Device& device, const Surface& surface, double tolerance, double looking_seconds = 2);
  ~AutoEvaluator() override;
  static constexpr double kLeastTolerance = 5e-4;
  static constexpr std::size_t kMostSamples = 16384;  ///< of a class, that calibration can use

  /// Chooses for every class of the sample, whose queries stand in random order; the first 256 of a class are
  /// used, up to kMostSamples where these cannot tell, and fewer where they take long. Queries of other
  /// classes go to `triangles`, and so do those of classes that are too small to repay a look.
  void calibrate(const CalibrationSample& sample);
  double tolerance() const { return tolerance_; }
  std::vector<AutoChoice> choices() const override { return choices_; }
  /// Calibrates by a sample of these.
  void calibrate(std::size_t count, const QuerySource& query, double scale) override;
  /// Element by element, where images that are looked at keep the tolerance so.
  std::unique_ptr<Painter> painter(std::size_t count, const QuerySource& footprint,
                                   const ImageWindow& window) override;

  /// How far `density`, the answer to a query, may be off: the class's error at 95% confidence, of the
  /// density where that is larger than is typical, and else of its geometric mean with the typical one.
  double error_estimate(const Query& query, double density) const override;

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override;
  std::string name() const override { return "auto"; }
  std::size_t device_bytes() const override;
  double build_seconds() const override;
  double device_seconds() const override;

 private:
  /// Queries of a class in random order, and the densities of those looked at so far.
  struct Samples {
    QueryClass kind;
    std::vector<Query> queries;
    double in_job = std::numeric_limits<double>::infinity();  ///< queries of the class that the job has
    double cost = 0;                                          ///< of one by triangles, core nanoseconds
    std::size_t counted = 0;                                  ///< of them that costs are told from
    std::size_t most = 0;                                     ///< that errors may be told from
    Candidate* reference = nullptr;                           ///< what they are compared with
    double reference_error = 0;                               ///< upper bound of its relative L2
    std::vector<float> expected = {};
  };
  enum class Verdict { keeps, breaks, costs_more };

  AutoChoice choose(Samples* samples);
  /// The cheapest of a method that keeps the tolerance, in place of `best` where it is cheaper.
  void choose_of(CandidateKind method, Samples* samples, AutoChoice* best);
  /// How far triangles are off.
  void check_triangles(Samples* samples, AutoChoice* choice);
  /// Exact ones, where samples contradict what triangles promise; but not of classes so dim that what they
  /// are off by is a small share of what all classes may be.
  void take_exact_triangles(const std::vector<Samples>& classes);
  void drop_what_nothing_uses();
  /// Compares with a precise pyramid in place of triangles, where these show that it is precise.
  void refer_to_pyramid(Samples* samples);
  /// @param choice its cost is the one to beat, and then the candidate's; and its error.
  Verdict judge(Candidate* candidate, Samples* samples, AutoChoice* choice);
  /// Nanoseconds of a core that a query takes, by the first `count`.
  double cost(Candidate* candidate, const std::vector<Query>& queries, std::size_t count);
  bool is_chosen(const Candidate& candidate) const;
  Evaluator* evaluator(Candidate* candidate);
  PyramidEvaluator* pyramid(Candidate* candidate);  ///< the same, of one that is a pyramid

  Device& device_;
  const Surface& surface_;
  double tolerance_, looking_seconds_;
  std::shared_ptr<PyramidStore> store_;  ///< of the candidates that are pyramids
  Candidates candidates_;
  double may_be_lost_ = 0;  ///< on structures that are built to be looked at, core nanoseconds
  std::unique_ptr<Evaluator> flops_counter_, elements_counter_;  // while it calibrates
  std::map<QueryClass, std::size_t> candidate_of_;
  std::vector<AutoChoice> choices_;
};

}  // namespace mica::host
