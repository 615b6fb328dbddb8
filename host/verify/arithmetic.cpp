#include "host/verify/arithmetic.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "host/base/constants.h"
#include "host/device/launch.h"

namespace mica::host {
namespace {

constexpr std::size_t kPoints = 1 << 20;

/// Arguments, whose numbers are multiples of a work-group's.
struct Arguments {
  std::vector<float> x, y;
};

std::uint32_t bits_of(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
float from_bits(std::uint32_t bits) {
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// From low to high > low > 0 by equal steps of the numbers' bits: as many in each octave.
std::vector<float> by_bits(float low, float high, std::size_t count) {
  std::vector<float> x(count);
  const std::uint64_t first = bits_of(low), last = bits_of(high);
  for (std::size_t n = 0; n < count; ++n)
    x[n] = from_bits(static_cast<std::uint32_t>(first + (last - first) * n / (count - 1)));
  return x;
}

/// By equal steps of the numbers' bits on both sides of zero, down to low.
std::vector<float> both_signs(float low, float high) {
  std::vector<float> x = by_bits(low, high, kPoints / 2);
  const std::vector<float> positive = x;
  for (const float value : positive) x.push_back(-value);
  return x;
}

std::vector<float> negated(std::vector<float> x) {
  for (float& value : x) value = -value;
  return x;
}

Arguments alone(std::vector<float> x) {
  std::vector<float> ones(x.size(), 1.0f);
  return {std::move(x), std::move(ones)};
}

Arguments circle() {
  Arguments arguments;
  for (std::size_t n = 0; n < kPoints; ++n) {
    const double angle = 2 * kPi * (static_cast<double>(n) + 0.5) / kPoints,
                 radius = std::exp2(n % 41 - 20.0);
    arguments.x.push_back(static_cast<float>(radius * std::cos(angle)));
    arguments.y.push_back(static_cast<float>(radius * std::sin(angle)));
  }
  return arguments;
}

Arguments quotients() {
  Arguments arguments{by_bits(1e-10f, 1e10f, kPoints), {}};
  for (std::size_t n = 0; n < kPoints; ++n) arguments.y.push_back(arguments.x[n * 2654435761u % kPoints]);
  return arguments;
}

struct Function {
  std::string name, kernel, range;
  Arguments (*arguments)();
  double (*exact)(double x, double y);
  double opencl_ulp, needed_ulp;
  double fixed_ulp = 0;  ///< where errors are absolute: the last place that they are counted in
};

/// What kernels need follows from their error budget in docs/accuracy.md: 2e-7 of a root or a reciprocal
/// is 3.4 ULP at the worst, 3e-6 of exp2 is 50, and 1.5e-7 of the normal distribution is 2.5 last places of a
/// half.
std::vector<Function> functions() {
  return {
      {"x / y", "arithmetic_divide", "1e-10 to 1e10", quotients, [](double x, double y) { return x / y; },
       2.5, 3.4},
      {"sqrt", "arithmetic_sqrt", "1e-30 to 1e30", [] { return alone(by_bits(1e-30f, 1e30f, kPoints)); },
       [](double x, double) { return std::sqrt(x); }, 3, 3.4},
      {"rsqrt", "arithmetic_rsqrt", "1e-30 to 1e30", [] { return alone(by_bits(1e-30f, 1e30f, kPoints)); },
       [](double x, double) { return 1 / std::sqrt(x); }, 2, 3.4},
      {"exp", "arithmetic_exp", "-87 to 87", [] { return alone(both_signs(1e-6f, 87)); },
       [](double x, double) { return std::exp(x); }, 3, 0},
      {"exp2", "arithmetic_exp2", "-125 to 125", [] { return alone(both_signs(1e-6f, 125)); },
       [](double x, double) { return std::exp2(x); }, 3, 0},
      {"log", "arithmetic_log", "1e-30 to 1e30", [] { return alone(by_bits(1e-30f, 1e30f, kPoints)); },
       [](double x, double) { return std::log(x); }, 3, 0},
      {"erf", "arithmetic_erf", "-4 to 4", [] { return alone(both_signs(1e-6f, 4)); },
       [](double x, double) { return std::erf(x); }, 16, 0},
      {"atan2", "arithmetic_atan2", "all angles, radii 1e-6 to 1e6", circle,
       [](double x, double y) { return std::atan2(y, x); }, 6, 0},
      {"Mica's rsqrt", "arithmetic_wave_rsqrt", "1e-30 to 1e30",
       [] { return alone(by_bits(1e-30f, 1e30f, kPoints)); },
       [](double x, double) { return 1 / std::sqrt(x); }, 0, 3.4},
      {"Mica's 1 / x", "arithmetic_wave_reciprocal", "1e-30 to 1e30",
       [] { return alone(by_bits(1e-30f, 1e30f, kPoints)); }, [](double x, double) { return 1 / x; }, 0, 3.4},
      {"Mica's exp2", "arithmetic_gaussian_exp2", "-126 to -1e-6",
       [] { return alone(negated(by_bits(1e-6f, 126, kPoints))); },
       [](double x, double) { return std::exp2(x); }, 0, 50},
      {"Mica's Phi - 1/2", "arithmetic_gaussian_cdf", "-9 to 9 deviations, last place of a half",
       [] { return alone(both_signs(1e-6f, 9 * 0.26189140f)); },
       [](double z, double) { return 0.5 * std::erf(z / 0.26189140 / std::sqrt(2.0)); }, 0, 2.5, 0x1p-24}};
}

std::vector<float> run(Device* device, const std::string& name, const Arguments& arguments) {
  cl::Kernel kernel = device->kernel("probes/arithmetic.cl", name, "");
  const cl::Buffer x = device->upload(arguments.x, "test values"),
                   y = device->upload(arguments.y, "test values");
  std::vector<float> z(arguments.x.size());
  const cl::Buffer output = device->buffer(z.size() * sizeof(float), CL_MEM_WRITE_ONLY, "test results");
  reporting("running " + name, [&] {
    launch(*device, kernel, launch_size(device->wave_form(), z.size() / kWaveLanes), x, y, output);
    device->queue().enqueueReadBuffer(output, CL_TRUE, 0, z.size() * sizeof(float), z.data());
  });
  return z;
}

/// Distance of neighbouring floats at `exact`.
double last_place(double exact) {
  return std::ldexp(1.0, std::max(std::ilogb(exact), -126) - 23);
}

FunctionError measure(Device* device, const Function& function) {
  FunctionError error;
  error.function = function.name, error.range = function.range;
  error.opencl_ulp = function.opencl_ulp, error.needed_ulp = function.needed_ulp;
  const Arguments arguments = function.arguments();
  const std::vector<float> answers = run(device, function.kernel, arguments);
  error.points = answers.size();
  for (std::size_t n = 0; n < answers.size(); ++n) {
    const double exact = function.exact(arguments.x[n], arguments.y[n]);
    const double ulp = function.fixed_ulp > 0 ? function.fixed_ulp : last_place(exact);
    const double ulps = std::isfinite(answers[n]) ? std::abs(answers[n] - exact) / ulp
                                                  : std::numeric_limits<double>::infinity();
    if (ulps > error.worst_ulp) error.worst_ulp = ulps, error.worst_at = arguments.x[n];
  }
  return error;
}

}  // namespace

std::vector<FunctionError> measure_arithmetic(Device* device) {
  std::vector<FunctionError> errors;
  for (const Function& function : functions()) errors.push_back(measure(device, function));
  return errors;
}

std::vector<Check> arithmetic_checks(const std::vector<FunctionError>& errors) {
  std::vector<Check> checks;
  for (const FunctionError& error : errors)
    if (error.needed_ulp > 0)
      checks.push_back({"arithmetic: " + error.function, error.points, error.worst_ulp / error.needed_ulp});
  return checks;
}

}  // namespace mica::host
