#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/base/findings.h"
#include "host/device/device.h"
#include "host/job/job.h"
#include "host/methods/evaluator.h"
#include "host/methods/patch_brdf.h"
#include "host/render/calibration_rows.h"
#include "host/render/lit_normals.h"
#include "host/render/plan.h"
#include "host/scene/scene.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Everything that a plan names, built: surfaces, scene, and evaluators on the device; at one frame.
class BuiltJob {
 public:
  /// At the job's first frame, or another of its frames. Job, plan and device must outlive it. Throws
  /// mica::Error.
  BuiltJob(const Job& job, const Plan& plan, Device& device);
  BuiltJob(const Job& job, const Plan& plan, Device& device, int frame, TraceRows trace = {});
  /// @param devices one or more, which share the queries of densities; each has all structures for them. All
  /// else is done by the first. Light
  /// that is gathered and patch BRDFs are not shared: see `check_sharing`.
  BuiltJob(const Job& job, const Plan& plan, const std::vector<Device*>& devices, int frame,
           TraceRows trace = {});

  /// Goes on to another frame: camera and lights move, surfaces that change are made again, and nothing else.
  void go_to(int frame);
  int frame() const { return frame_; }

  const Job& job() const { return job_; }
  const Plan& plan() const { return plan_; }
  const Scene& scene() const { return scene_; }
  bool sees_scene() const { return !traces_otherwise_; }  ///< by the scene's camera; not TraceRows of others
  TracedRows trace(int first_row, int row_count) const { return trace_(scene_, first_row, row_count); }
  /// The same, of which methods that choose may have traced some before: each once.
  TracedRows take_rows(int first_row, int row_count);
  /// By PlannedEvaluator; only one that asks for densities.
  Evaluator& evaluator(std::size_t n) const { return *evaluators_[n]; }
  std::vector<Evaluator*> evaluators() const;  ///< likewise; null for the others
  /// Whether the evaluator of a query's material may answer more than 0; see LitNormals. Methods that
  /// approximate the map by something else than its normals are always asked.
  bool may_answer(const GlintQuery& glint) const;
  /// By PlannedEvaluator; of one that is a patch BRDF, and of all when light is gathered.
  PatchBrdf& brdf(std::size_t n) const { return *brdfs_[n]; }
  std::vector<const Surface*> surfaces() const;  ///< by PlannedEvaluator; null without a map
  /// One as exact as there is: `triangles` on its map; null without a map.
  std::unique_ptr<Evaluator> make_exact_evaluator(std::size_t n) const;

  // Seconds that the latest frame took to build.
  double surface_seconds() const { return surface_seconds_; }
  double scene_seconds() const { return scene_seconds_; }
  double build_seconds() const { return build_seconds_; }
  double trace_seconds() const { return trace_seconds_; }  ///< of rows of the picture that were traced before
  std::size_t device_bytes() const;                        ///< of all structures, as allocated
  double device_seconds() const;                           ///< that kernels ran so far, by the device's clock

  /// The largest of its surfaces; see mica::host::precision_error. For each, its materials' least roughness.
  double precision_error() const;
  std::size_t replaced_answers() const;  ///< so far; see Evaluator::replaced

  const std::string& inputs() const { return inputs_; }  ///< hash_of_inputs of the job
  std::vector<std::string> notes() const;                ///< of surfaces and images
  std::vector<std::string> warnings() const;             ///< of surfaces and images

 private:
  Surface make_surface_of(std::size_t n, int frame);
  double least_roughness(std::size_t n) const;  ///< of its materials
  void build_evaluators(const std::vector<std::size_t>& changed);
  void build_evaluator(std::size_t n);
  Scene scene_at(int frame) const;
  std::vector<std::optional<Surface>> make_surfaces();
  std::vector<SmoothLobe> smooth_lobes() const;
  LightGathering gathering() const;
  PixelSettings pixels() const;
  double device_seconds_of(std::size_t n) const;
  std::size_t replaced_answers_of(std::size_t n) const;
  Scene make_scene();
  std::unique_ptr<Evaluator> make_density_evaluator(std::size_t n);
  void calibrate(std::size_t n, Evaluator* evaluator);
  const Surface* surface(std::size_t n) const { return surfaces_[n] ? &*surfaces_[n] : nullptr; }
  std::unique_ptr<PatchBrdf> make_brdf(std::size_t n) const;

  const Job& job_;
  const Plan& plan_;
  std::vector<Device*> devices_;  // those that share densities
  Device& device_;                // the first
  /// Of all frames, and of the present one; for methods that choose, while evaluators are built.
  std::optional<SomeQueries> of_all_frames_, of_frame_;
  std::vector<TracedRows> traced_;  ///< of these, blocks of this frame that are yet to be asked for
  bool traces_otherwise_;
  TraceRows trace_;
  int frame_;
  double surface_seconds_ = 0, scene_seconds_ = 0, build_seconds_ = 0, trace_seconds_ = 0;
  std::string inputs_;
  double past_device_seconds_ = 0;  // of evaluators that are no more
  std::size_t past_replaced_answers_ = 0;
  // By PlannedEvaluator: what was found of the surface, what its method chose, and the surface.
  std::vector<Findings> surface_findings_;
  std::vector<double> precision_errors_;  // of surfaces
  std::vector<std::vector<std::string>> choices_;
  std::vector<std::optional<Surface>> surfaces_;
  Scene scene_;
  std::vector<std::unique_ptr<Evaluator>> evaluators_;
  std::vector<std::unique_ptr<PatchBrdf>> brdfs_;
  std::vector<std::optional<LitNormals>> lit_normals_;  // of methods that answer for the map's normals
};

}  // namespace mica::host
