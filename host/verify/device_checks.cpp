#include "host/verify/device_checks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "host/device/launch.h"
#include "kernels/images/image_types.h"
#include "kernels/pyramid/pyramid_types.h"
#include "kernels/struct_layout.h"
#include "kernels/types.h"

namespace mica::host {
namespace {

std::vector<cl_int> host_layout() {
  using namespace device_types;
#define SIZE(type) static_cast<cl_int>(sizeof(type)),
#define OFFSET(type, field) static_cast<cl_int>(offsetof(type, field)),
  return {MICA_STRUCT_LAYOUT(SIZE, OFFSET)};
#undef SIZE
#undef OFFSET
}

/// f of every x, whose number is a multiple of 256.
std::vector<float> run(Device* device, const std::string& kernel_name, WaveForm form,
                       const std::vector<float>& x) {
  cl::Kernel kernel = device->kernel("probes/selftest.cl", kernel_name, "", form);
  const cl::Buffer input = device->upload(x, "test values");
  const cl::Buffer output = device->buffer(x.size() * sizeof(float), CL_MEM_WRITE_ONLY, "test results");
  std::vector<float> y(x.size());
  reporting("running " + kernel_name, [&] {
    launch(*device, kernel, launch_size(form, x.size() / kWaveLanes), input, output);
    device->queue().enqueueReadBuffer(output, CL_TRUE, 0, y.size() * sizeof(float), y.data());
  });
  return y;
}

std::vector<float> evenly_spaced(double first, double last) {
  std::vector<float> x(1 << 16);
  for (std::size_t n = 0; n < x.size(); ++n)
    x[n] = static_cast<float>(first +
                              (last - first) * static_cast<double>(n) / static_cast<double>(x.size() - 1));
  return x;
}

struct SpecialFunction {
  std::string kernel, name;
  double first, last;
  double (*exact)(double);
  double absolute, relative;  // error allowed
};

const SpecialFunction kSpecialFunctions[] = {
    {"selftest_gaussian_exp2", "exp2", -126, 0, [](double x) { return std::exp2(x); }, 0, 3e-6},
    {"selftest_gaussian_cdf_centred", "Gaussian integral", -1.7, 1.7,
     [](double z) { return 0.5 * std::erf(2.7 * z); }, 3e-7, 0}};  // x = 5.4 z / sqrt(2)

Check check_special_function(Device* device, const SpecialFunction& function, WaveForm form) {
  const std::string form_name = form == WaveForm::items ? "work-items" : "vectors";
  Check check{function.name + " as " + form_name};
  const std::vector<float> x = evenly_spaced(function.first, function.last);
  const std::vector<float> y = run(device, function.kernel, form, x);
  check.points = x.size();
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double exact = function.exact(x[n]);
    const double error = std::abs(y[n] - exact) / (function.absolute + function.relative * std::abs(exact));
    if (!(error <= check.worst)) check.worst = error;  // also NaN
  }
  return check;
}

}  // namespace

Check check_struct_layout(Device* device) {
  const std::vector<cl_int> expected = host_layout();
  std::vector<cl_int> found(expected.size());
  cl::Kernel kernel = device->kernel("probes/selftest.cl", "selftest_layout", "");
  const std::size_t bytes = found.size() * sizeof found[0];
  const cl::Buffer output = device->buffer(bytes, CL_MEM_WRITE_ONLY, "the structs' layout");
  reporting("running selftest_layout", [&] {
    launch(*device, kernel, {1, 1}, output);
    device->queue().enqueueReadBuffer(output, CL_TRUE, 0, bytes, found.data());
  });
  Check check{"layout of shared structs", found.size()};
  if (found != expected) check.worst = std::numeric_limits<double>::infinity();
  return check;
}

std::vector<Check> check_special_functions(Device* device) {
  std::vector<Check> checks;
  for (const SpecialFunction& function : kSpecialFunctions) {
    for (const WaveForm form : {WaveForm::vectors, WaveForm::items}) {
      try {
        checks.push_back(check_special_function(device, function, form));
      } catch (const DeviceError& error) {
        if (form == device->wave_form()) throw;
        checks.push_back({function.name, 0, 0, error.what()});  // a form that this device need not know
      }
    }
  }
  return checks;
}

}  // namespace mica::host
