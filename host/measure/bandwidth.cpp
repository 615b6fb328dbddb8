#include "host/measure/bandwidth.h"

#include <algorithm>

namespace mica::host::bench {

double measure_bandwidth(Device& device) {
  constexpr std::size_t kWaves = 1 << 20, kLanes = 16, kRuns = 6;  // 64 MiB an array
  const bool vectors = device.wave_form() == WaveForm::vectors;
  const std::size_t bytes = kWaves * kLanes * sizeof(float);
  cl::Kernel kernel = device.kernel("probes/triad.cl", "triad", "");
  const cl::Buffer a = device.buffer(bytes, CL_MEM_READ_WRITE, "the triad's result");
  const std::vector<float> ones(kWaves * kLanes, 1.0f);
  const cl::Buffer b = device.upload(ones, "the triad's operand"),
                   c = device.upload(ones, "the triad's operand");
  double best = 0;
  try {
    kernel.setArg(0, a);
    kernel.setArg(1, b);
    kernel.setArg(2, c);
    kernel.setArg(3, 0.5f);
    for (std::size_t run = 0; run < kRuns; ++run) {
      cl::Event event;
      device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, vectors ? kWaves : kWaves * kLanes,
                                          vectors ? 64 : kLanes, nullptr, &event);
      event.wait();
      const double seconds = 1e-9 * static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                                        event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
      if (run > 0) best = std::max(best, 3.0 * static_cast<double>(bytes) / seconds);  // 0 touches the pages
    }
  } catch (const cl::Error& error) {
    throw opencl_error(error, "measuring the memory's bandwidth");
  }
  return best;
}

}  // namespace mica::host::bench
