#pragma once

#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/methods/map/image_window.h"
#include "kernels/pyramid/pyramid_types.h"

namespace mica::host {

/// Images of P-NDFs, element by element on the device: kernels/images/splat.h. An image depends on its
/// footprint and the window alone, not on the batch it is in.
class ImageBatches {
 public:
  /// @param method path of the kernel: "images/pyramid_images", see Device::kernel.
  /// @param grid, structure the kernel's arguments between the window and the images.
  ImageBatches(Device& device, const device_types::mica_map_grid& grid, std::vector<cl::Buffer> structure,
               const std::string& method, const std::string& options, WaveForm wave_form);

  /// One image a query, whose half vector does not matter; 0 off the disk, else >= 0 or not finite. Throws
  /// DeviceError.
  std::vector<float> draw(const std::vector<device_types::mica_pyramid_query>& queries,
                          const ImageWindow& window);

 private:
  void draw_batch(const device_types::mica_pyramid_query* queries, std::size_t count,
                  const ImageWindow& window, float* images);

  Device& device_;
  std::string method_;
  WaveForm wave_form_;
  device_types::mica_map_grid grid_;
  std::vector<cl::Buffer> structure_;
  cl::Kernel kernel_;
};

}  // namespace mica::host
