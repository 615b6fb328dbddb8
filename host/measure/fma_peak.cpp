#include "host/measure/fma_peak.h"

#include <algorithm>

namespace mica::host::bench {

double measure_fma_peak(Device& device) {
  constexpr int kRounds = 20000, kChains = 12, kLanes = 16, kRuns = 8;
  const bool vectors = device.wave_form() == WaveForm::vectors;
  const std::size_t waves = 64 * device.info().compute_units;
  const std::size_t items = vectors ? waves : waves * kLanes, group = vectors ? 16 : kLanes;
  cl::Kernel kernel = device.kernel("probes/fma_peak.cl", "fma_peak", "");
  const cl::Buffer result = device.buffer(waves * sizeof(float), CL_MEM_WRITE_ONLY, "the peak's result");
  double best = 0;
  try {
    kernel.setArg(0, kRounds);
    kernel.setArg(1, 0.999f);
    kernel.setArg(2, result);
    for (int run = 0; run < kRuns; ++run) {
      cl::Event event;
      device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, items, group, nullptr, &event);
      event.wait();
      const double seconds = 1e-9 * static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                                        event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
      best = std::max(best, 2.0 * kChains * kRounds * kLanes * static_cast<double>(waves) / seconds);
    }
  } catch (const cl::Error& error) {
    throw opencl_error(error, "measuring the multiply-add peak");
  }
  return best;
}

}  // namespace mica::host::bench
