#pragma once

#include <string>
#include <vector>

#include "host/methods/evaluator.h"
#include "host/methods/normal_draws.h"
#include "host/methods/patch_brdf.h"
#include "host/surface/surface.h"

namespace mica::host {

/// A P-NDF as a BRDF: f_r max(i.n, 0) = D(h) G(o, i) / (4 o.n), [Yan14] Eq. 1, with the Smith masking of the
/// map as a whole. It is not normalised for the patch: what masking takes is lost, what shadowed normals of
/// the patch do not take is too much.
///
/// Directions are drawn from a mixture of which the density is known exactly: the visible normals of a smooth
/// lobe with the moments of the whole map, a cosine lobe and, where D is the density of the surface's own
/// normals, a normal of the surface at a point of the footprint, blurred by the roughness [Yan14 sec. 6].
class NdfBrdf : public PatchBrdf, public NormalDraws {
 public:
  enum class Draws {
    surface_normals,  ///< the evaluator answers [Yan14] Eq. 6 of `surface`, and nothing else
    smooth_lobe
  };

  /// @param evaluator of the density of `surface`'s normals; both must outlive this.
  NdfBrdf(Evaluator& evaluator, const Surface& surface, Draws draws);

  std::vector<BrdfValue> evaluate(const std::vector<BrdfQuery>& queries) override;

  /// By a thousand draws: good to a few percent.
  std::vector<Albedo> energy(const std::vector<ViewQuery>& queries) override;

  std::vector<BrdfSample> sample(const std::vector<SampleQuery>& queries) override;

  Drawn draw_normal(const ViewQuery& from, const Eigen::Vector4d& uniform) const override;
  double normal_weight(const BrdfQuery& query) const override;

  /// Itself where D is the density of the surface's own normals, otherwise none.
  const NormalDraws* normal_draws() const { return normal_share_ > 0 ? this : nullptr; }

  std::string name() const override { return evaluator_.name(); }
  std::size_t device_bytes() const override { return 0; }  // the evaluator's are its own
  double build_seconds() const override { return 0; }
  double device_seconds() const override { return evaluator_.device_seconds(); }

 private:
  Eigen::Vector3d draw(const SampleQuery& query) const;
  Eigen::Vector3d surface_normal(const ViewQuery& from, const Eigen::Vector4d& uniform) const;
  double masking(const BrdfQuery& query) const;
  BrdfValue value(const BrdfQuery& query, double density) const;
  Eigen::Matrix2d lobe_moments(double roughness) const;

  Evaluator& evaluator_;
  const Surface& surface_;
  Eigen::Matrix2d slope_moments_;  // of the map, about 0
  double normal_share_, lobe_share_, cosine_share_;
};

}  // namespace mica::host
