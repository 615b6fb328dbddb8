#include "host/device/launch.h"

namespace mica::host {

LaunchSize launch_size(WaveForm form, std::size_t waves, std::size_t waves_a_group) {
  if (form == WaveForm::items) return {waves * kWaveLanes, kWaveLanes};
  return {(waves + waves_a_group - 1) / waves_a_group * waves_a_group, waves_a_group};
}

double seconds_of(const cl::Event& done) {
  return 1e-9 * static_cast<double>(done.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                    done.getProfilingInfo<CL_PROFILING_COMMAND_START>());
}

}  // namespace mica::host
