#include "host/engine/pyramid_level_batches.h"

#include <fmt/format.h>

namespace mica {

PyramidLevelBatches::PyramidLevelBatches(Device& device, const PyramidLevel& level, WaveForm wave_form,
                                         bool count_elements, std::size_t batch_queries)
    : shape_(level.shape),
      buffers_({device.upload(level.groups, "the pyramid's groups"),
                device.upload(level.top_nodes, "the pyramid's bounds"),
                device.upload(level.nodes, "the pyramid's bounds"),
                device.upload(level.records, "the pyramid's elements")}),
      batches_(device, level.shape.grid, buffers_, level.bytes(), "pyramid",
               fmt::format("-DMICA_COUNT_ELEMENTS={}", static_cast<int>(count_elements)), wave_form,
               batch_queries) {}

}  // namespace mica
