#include "host/measure/bandwidth.h"

#include <algorithm>

#include "host/device/launch.h"

namespace mica::host::bench {

double measure_bandwidth(Device& device) {
  constexpr std::size_t kWaves = 1 << 20, kWavesAGroup = 64, kRuns = 6;  // 64 MiB an array
  const std::size_t bytes = kWaves * kWaveLanes * sizeof(float);
  cl::Kernel kernel = device.kernel("probes/triad.cl", "triad", "");
  const cl::Buffer a = device.buffer(bytes, CL_MEM_READ_WRITE, "the triad's result");
  const std::vector<float> ones(kWaves * kWaveLanes, 1.0f);
  const cl::Buffer b = device.upload(ones, "the triad's operand"),
                   c = device.upload(ones, "the triad's operand");
  double best = 0;
  const LaunchSize size = launch_size(device.wave_form(), kWaves, kWavesAGroup);
  reporting("measuring the memory's bandwidth", [&] {
    for (std::size_t run = 0; run < kRuns; ++run) {
      const cl::Event done = launch(device, kernel, size, a, b, c, 0.5f);
      done.wait();
      if (run > 0)  // 0 touches the pages
        best = std::max(best, 3.0 * static_cast<double>(bytes) / seconds_of(done));
    }
  });
  return best;
}

}  // namespace mica::host::bench
