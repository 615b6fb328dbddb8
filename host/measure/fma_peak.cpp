#include "host/measure/fma_peak.h"

#include <algorithm>

#include "host/device/launch.h"

namespace mica::host::bench {

double measure_fma_peak(Device& device) {
  constexpr int kRounds = 20000, kChains = 12, kRuns = 8;
  const std::size_t waves = 64 * device.info().compute_units;
  cl::Kernel kernel = device.kernel("probes/fma_peak.cl", "fma_peak", "");
  const cl::Buffer result = device.buffer(waves * sizeof(float), CL_MEM_WRITE_ONLY, "the peak's result");
  double best = 0;
  reporting("measuring the multiply-add peak", [&] {
    for (int run = 0; run < kRuns; ++run) {
      const cl::Event done =
          launch(device, kernel, launch_size(device.wave_form(), waves), kRounds, 0.999f, result);
      done.wait();
      best = std::max(best,
                      2.0 * kChains * kRounds * kWaveLanes * static_cast<double>(waves) / seconds_of(done));
    }
  });
  return best;
}

}  // namespace mica::host::bench
