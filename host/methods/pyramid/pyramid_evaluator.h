#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/pyramid/pyramid_query.h"
#include "host/methods/pyramid/pyramid_store.h"
#include "host/surface/surface.h"

namespace mica::host {

struct PyramidSettings {
  PyramidPrecision precision;
  std::optional<std::size_t> levels_bytes;  ///< of a roughness's levels; default: pyramid_levels_bytes
  std::size_t batch_queries = 1 << 17;      ///< queries a launch, at most
  std::optional<WaveForm> wave_form;        ///< default: what suits the device
  std::shared_ptr<PyramidStore> store;      ///< of levels, whose settings then count; default: its own
};

/// `pyramid`: merged elements, whose number does not grow with the footprint; kernels/pyramid/pyramid.cl.
/// Levels are built when the first query needs them. Footprints that are too small for the finest level go to
/// the texels themselves, and so does a roughness whose levels would merge hardly any.
class PyramidEvaluator : public Evaluator {
 public:
  /// Builds nothing yet. `device` and `surface` must outlive the evaluator.
  PyramidEvaluator(Device& device, const Surface& surface, const PyramidSettings& settings = {});

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override;
  std::unique_ptr<Painter> painter(std::size_t count, const QuerySource& footprint,
                                   const ImageWindow& window) override;
  std::string name() const override { return "pyramid"; }
  /// Without a store that was given.
  std::size_t device_bytes() const override;
  double build_seconds() const override;
  double device_seconds() const override;

  /// Numbers of elements that queries sum; of those that go to the texels, of what their kernel counts. Of
  /// queries with a first order those under the places that they see.
  std::vector<float> count_elements(const std::vector<Query>& queries);

  /// The level that a query reads, none: the texels.
  std::optional<PyramidChoice> choose(const Query& query);

  /// That of a choice; built when it is not there.
  PyramidLevelBatches& level(const PyramidChoice& choice);

  const PyramidSettings& settings() const { return settings_; }
  WaveForm wave_form() const { return store_->wave_form(); }

 private:
  /// Queries that one level answers, and what its answers count.
  struct Share {
    std::vector<std::uint32_t> places;
    std::vector<float> weights;
  };
  struct LevelsOfQueries {
    std::map<PyramidChoice, Share> by_level;
    std::vector<std::uint32_t> small;  ///< queries for the texels
  };
  /// What a level's queries leave out, and the factor that makes up for it.
  struct Culling {
    double cutoff = 0, gain = 1;
  };
  class BlendedDensities;

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries, bool counting);
  std::unique_ptr<PendingDensities> start_turned(const std::vector<Query>& queries);
  LevelsOfQueries levels_of(const std::vector<Query>& queries, bool counting);
  void add_levels(double roughness);
  /// Of levels that were added.
  std::optional<PyramidShares> shares(const Query& query) const;
  int whole_map(int cell_class) const;
  std::vector<device_types::mica_pyramid_query> level_queries(const std::vector<Query>& queries,
                                                              const std::vector<std::uint32_t>& places,
                                                              const PyramidChoice& choice,
                                                              const Culling& culling);
  Culling culling(const PyramidChoice& choice);
  std::vector<Query> culling_sample(const PyramidChoice& choice) const;
  Evaluator* texels(bool counting);

  Device& device_;
  const Surface& surface_;
  PyramidSettings settings_;
  std::shared_ptr<PyramidStore> store_;
  double build_seconds_ = 0;
  std::map<int, PyramidLevels> levels_of_class_;
  std::set<int> unmerged_classes_;  ///< whose queries go to the texels; see hardly_merges
  std::map<PyramidChoice, Culling> cullings_;
  std::unique_ptr<Evaluator> texels_, counting_texels_;
};

}  // namespace mica::host
