#pragma once

#include <map>
#include <optional>
#include <vector>

#include "host/methods/map/image_batches.h"
#include "host/methods/pyramid/pyramid_evaluator.h"

namespace mica::host {

/// Images of P-NDFs with the accuracy of `pyramid`, element by element into the image and not query by query:
/// merged elements where the pyramid has a level for the footprint, pieces of the texels' triangles where it
/// has none. What neither can draw goes query by query.
class PyramidPainter : public Painter {
 public:
  /// All must outlive the painter.
  PyramidPainter(Device& device, const Surface& surface, PyramidEvaluator& pyramid);

  /// One image a query, whose half vector does not matter; 0 off the disk.
  std::vector<float> paint(const std::vector<Query>& footprints, const ImageWindow& window) override;

  /// Who draws a footprint.
  enum class Way { level, texels, queries };
  Way way(const Query& query);

 private:
  std::vector<float> paint_level(const std::vector<Query>& footprints, const PyramidChoice& choice,
                                 const ImageWindow& window);
  std::vector<float> paint_texels(const std::vector<Query>& footprints, const ImageWindow& window);
  std::vector<float> paint_queries(const std::vector<Query>& footprints, const ImageWindow& window);

  Device& device_;
  const Surface& surface_;
  PyramidEvaluator& pyramid_;
  double cutoff_;
  std::map<PyramidChoice, ImageBatches> levels_;  // by choices that are not uniform
  std::optional<ImageBatches> texels_;
};

}  // namespace mica::host
