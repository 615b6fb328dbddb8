#include "host/methods/map/image_batches.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "host/device/launch.h"
#include "kernels/images/image_types.h"

namespace mica::host {
namespace {

using namespace device_types;

constexpr std::size_t kBatchBytes = std::size_t{64} << 20;  // of images on the device at a time

mica_image_window to_device(const ImageWindow& window) {
  mica_image_window result{};
  const double to_corner = window.radius - 0.5 * window.step();
  result.left_s = static_cast<float>(window.center.x() - to_corner);
  result.bottom_t = static_cast<float>(window.center.y() - to_corner);
  result.step = static_cast<float>(window.step());
  result.pixels = window.pixels;
  result.squares = (window.pixels + MICA_IMAGE_SQUARE - 1) / MICA_IMAGE_SQUARE;
  return result;
}

/// From squares of pixels, bottom up, to rows of them, top down.
void unfold(const float* squares, const ImageWindow& window, int squares_a_row, float* image) {
  constexpr std::size_t side = MICA_IMAGE_SQUARE;
  const auto pixels = static_cast<std::size_t>(window.pixels);
  for (const std::size_t pixel : window.pixels_on_disk()) {
    const std::size_t column = pixel % pixels, row = pixels - 1 - pixel / pixels;
    const std::size_t square = row / side * static_cast<std::size_t>(squares_a_row) + column / side;
    image[pixel] = squares[square * kWaveLanes + row % side * side + column % side];
  }
}

}  // namespace

ImageBatches::ImageBatches(Device& device, const mica_map_grid& grid, std::vector<cl::Buffer> structure,
                           const std::string& method, const std::string& options, WaveForm wave_form)
    : device_(device),
      method_(method),
      wave_form_(wave_form),
      grid_(grid),
      structure_(std::move(structure)),
      kernel_(device.kernel(method, options, wave_form)) {}

std::vector<float> ImageBatches::draw(const std::vector<mica_pyramid_query>& queries,
                                      const ImageWindow& window) {
  const mica_image_window on_device = to_device(window);
  const std::size_t image_bytes =
      static_cast<std::size_t>(on_device.squares) * on_device.squares * kWaveLanes * sizeof(float);
  const std::size_t most =
      std::max<std::size_t>(std::min(kBatchBytes, device_.info().allocation_bytes) / image_bytes, 1);
  std::vector<float> images(queries.size() * window.count());
  for (std::size_t first = 0; first < queries.size(); first += most)
    draw_batch(queries.data() + first, std::min(most, queries.size() - first), window,
               images.data() + first * window.count());
  return images;
}

void ImageBatches::draw_batch(const mica_pyramid_query* queries, std::size_t count, const ImageWindow& window,
                              float* images) {
  const mica_image_window on_device = to_device(window);
  const std::size_t image_floats =
      static_cast<std::size_t>(on_device.squares) * on_device.squares * kWaveLanes;
  const std::size_t query_bytes = count * sizeof(mica_pyramid_query);
  const std::size_t bands =
      count * ((static_cast<std::size_t>(window.pixels) + MICA_IMAGE_BAND - 1) / MICA_IMAGE_BAND);
  const cl::Buffer input = device_.buffer(query_bytes, CL_MEM_READ_ONLY, "footprints of images");
  const cl::Buffer output =
      device_.buffer(count * image_floats * sizeof(float), CL_MEM_READ_WRITE, "a batch of images");
  std::vector<float> squares(count * image_floats);
  reporting("running " + method_, [&] {
    device_.queue().enqueueWriteBuffer(input, CL_TRUE, 0, query_bytes, queries);
    const LaunchSize size = launch_size(wave_form_, bands, 1);  // a band is much work: one a work-group
    launch(device_, kernel_, size, input, static_cast<cl_int>(bands), on_device, grid_, structure_, output);
    device_.queue().enqueueReadBuffer(output, CL_TRUE, 0, squares.size() * sizeof(float), squares.data());
  });
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
    unfold(squares.data() + n * image_floats, window, on_device.squares, images + n * window.count());
  });
}

}  // namespace mica::host
