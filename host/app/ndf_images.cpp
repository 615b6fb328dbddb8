#include "host/app/ndf_images.h"

#include "host/app/progress.h"
#include "host/base/interrupt.h"
#include "host/base/stopwatch.h"
#include "host/methods/draw_images.h"

namespace mica::host::app {

std::vector<float> draw_with_progress(const OpenEvaluator& open, std::size_t count,
                                      const QuerySource& footprint, const ImageWindow& window) {
  Progress progress("images", false);
  const Stopwatch watch;
  std::vector<float> images = draw_images(*open.evaluator, count, footprint, window, [&](std::size_t done) {
    check_interrupt();
    if (watch.seconds() > 1) progress.update(static_cast<long>(done), static_cast<long>(count));
  });
  log_choices(open);
  return images;
}

}  // namespace mica::host::app
