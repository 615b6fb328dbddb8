#include "host/device/launch.h"

#include <gtest/gtest.h>

namespace mica::host::launch_test {
namespace {

void expect_size(const LaunchSize& size, std::size_t global, std::size_t local) {
  EXPECT_EQ(size.global, global);
  EXPECT_EQ(size.local, local);
}

TEST(LaunchSize, IsAWorkItemAWaveInWholeGroupsOnACpu) {
  expect_size(launch_size(WaveForm::vectors, 16), 16, 16);
  expect_size(launch_size(WaveForm::vectors, 17), 32, 16);
  expect_size(launch_size(WaveForm::vectors, 5, 1), 5, 1);
  expect_size(launch_size(WaveForm::vectors, 65, 64), 128, 64);
}

TEST(LaunchSize, IsAWorkGroupAWaveOnAGpu) {
  expect_size(launch_size(WaveForm::items, 17), 17 * 16, 16);
  expect_size(launch_size(WaveForm::items, 5, 64), 5 * 16, 16);
}

// An argument that a kernel does not have is an error of OpenCL's, which says what was done.
TEST(Launch, ReportsWhatItWasDoing) {
  Device device(0);
  cl::Kernel kernel = device.kernel("probes/triad.cl", "triad", "");
  const cl::Buffer buffer = device.buffer(64, CL_MEM_READ_WRITE, "a test");
  try {
    reporting("running a test", [&] {
      launch(device, kernel, {16, 16}, std::vector<cl::Buffer>(3, buffer), 0.5f, 1.0f);
    });
    FAIL() << "no error";
  } catch (const DeviceError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("running a test: clSetKernelArg: ", 0), 0u) << error.what();
  }
}

}  // namespace
}  // namespace mica::host::launch_test
