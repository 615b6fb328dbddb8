#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/engine/evaluator.h"
#include "host/engine/grid_evaluator.h"
#include "host/engine/patch_brdf.h"
#include "host/engine/plan.h"
#include "host/job/job.h"
#include "host/scene/scene.h"
#include "host/surface/surface.h"

namespace mica {

/// Everything that a plan names, built: surfaces, scene, and evaluators on the device.
class BuiltJob {
 public:
  /// All three must outlive it. Throws mica::Error.
  BuiltJob(const Job& job, const Plan& plan, Device& device);

  const Job& job() const { return job_; }
  const Plan& plan() const { return plan_; }
  const Scene& scene() const { return scene_; }
  Evaluator& evaluator(std::size_t n) const { return *evaluators_[n]; }  ///< by PlannedEvaluator
  PatchBrdf& brdf(std::size_t n) const { return *brdfs_[n]; }            ///< the same; if light is gathered
  std::vector<const Surface*> surfaces() const;  ///< by PlannedEvaluator; null without a map
  GridEvaluator* glints(std::size_t n) const { return glints_[n]; }  ///< the same; null with a map

  double surface_seconds() const { return surface_seconds_; }
  double scene_seconds() const { return scene_seconds_; }
  double build_seconds() const { return build_seconds_; }
  std::size_t device_bytes() const;  ///< of all structures, as allocated
  double device_seconds() const;     ///< that kernels ran so far, by the device's clock

  const std::vector<std::string>& notes() const { return notes_; }        ///< of the surfaces
  const std::vector<std::string>& warnings() const { return warnings_; }  ///< of the surfaces

 private:
  std::vector<std::optional<Surface>> make_surfaces();
  Scene make_scene();
  std::unique_ptr<PatchBrdf> make_brdf(std::size_t n, Device& device) const;

  const Job& job_;
  const Plan& plan_;
  double surface_seconds_ = 0, scene_seconds_ = 0, build_seconds_ = 0;
  std::vector<std::string> notes_, warnings_;
  std::vector<std::optional<Surface>> surfaces_;  // by PlannedEvaluator
  Scene scene_;
  std::vector<std::unique_ptr<Evaluator>> evaluators_;
  std::vector<GridEvaluator*> glints_;  // those of evaluators_ that are
  std::vector<std::unique_ptr<PatchBrdf>> brdfs_;
};

/// The densities of a block of traced rows, on their way from all evaluators.
class PendingBlock {
 public:
  PendingBlock(TracedRows rows, const BuiltJob& built);

  /// Once waited for, the weights of glints are tinted by their colours.
  const TracedRows& rows() const { return rows_; }
  /// D of every query, in the order of rows().queries. Call once.
  std::vector<float> wait();

 private:
  struct Part {
    std::vector<std::size_t> places;
    std::unique_ptr<PendingDensities> pending;
    const GridDensities* glints = nullptr;  // `pending`, when it has colours
    std::vector<Eigen::Vector3d> colors;
  };
  void start_glints(std::size_t evaluator, const BuiltJob& built, const std::vector<Query>& queries);
  void tint(const Part& part, const std::vector<float>& densities);

  TracedRows rows_;
  std::vector<Part> parts_;  // by evaluator
};

}  // namespace mica
