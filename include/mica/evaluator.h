#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mica/control.h"
#include "mica/device.h"
#include "mica/method.h"
#include "mica/query.h"
#include "mica/settings.h"
#include "mica/surface.h"

MICA_BEGIN_NAMESPACE

/// A square image over the disk of half vectors: pixels row by row from the top left, s to the right, t up.
struct PndfWindow {
  double center_s = 0, center_t = 0;
  double radius = 1;  ///< half its side
  int pixels = 256;   ///< a side, 1 to 8192
};

/// Answers queries for densities by one method. Keeps its device and its map alive. Copies are the same
/// evaluator; calls from several threads wait for each other.
class MICA_API Evaluator {
 public:
  /// @param method "triangles", "gaussians", "beckmanns", "smooth", "pyramid", "auto", "reference" or one of
  /// yours.
  /// @param settings its own by their keys, and `tolerance` for those that keep one.
  /// Throws UsageError and DeviceError.
  Evaluator(const Device& device, const NormalMap& map, const std::string& method,
            const Settings& settings = {}, const Methods& methods = {});
  /// Of a method without a map: "grid".
  Evaluator(const Device& device, const std::string& method, const Settings& settings = {},
            const Methods& methods = {});

  /// D of each query. @param densities as many as there are queries. The first call of `auto` chooses by a
  /// sample of its queries. Throws UsageError, which names the first query that cannot be answered; nothing
  /// is written then.
  void evaluate(const Queries& queries, Span<float> densities, const RunControl& control = {}) const;
  void evaluate(const Queries& queries, Span<double> densities, const RunControl& control = {}) const;
  std::vector<float> evaluate(const Queries& queries, const RunControl& control = {}) const;

  /// How far each density may be off, of methods that tell: "auto" (its class of queries' relative L2 at 95%
  /// confidence), "triangles" and "reference". @param densities the answers to `queries`. @param errors as
  /// many. Throws UsageError for other methods.
  void estimate_errors(const Queries& queries, Span<const float> densities, Span<float> errors) const;

  /// P-NDFs as images: D at the centres of pixels, 0 off the disk. @param roughness of each footprint.
  /// @param images count * pixels * pixels numbers.
  void draw(const Footprints& footprints, const Column& roughness, const PndfWindow& window,
            Span<float> images, const RunControl& control = {}) const;

  std::string method() const;
  /// What a method that chooses among others chose, a line for each kind of query.
  std::vector<std::string> choices() const;
  std::size_t device_bytes() const;  ///< of its structures
  double build_seconds() const;      ///< that these took on the host
  double device_seconds() const;     ///< that its kernels ran so far, by the device's own clock

  class Implementation;

 private:
  std::shared_ptr<Implementation> implementation_;
};

MICA_END_NAMESPACE
