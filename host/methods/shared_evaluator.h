#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "host/methods/evaluator.h"
#include "host/methods/method.h"

namespace mica::host {

/// One of several devices that share the queries of an evaluator.
struct DeviceShare {
  std::string device;                    ///< as errors name it
  std::unique_ptr<Evaluator> evaluator;  ///< on that device alone
};

/// Evaluators of one method on one surface, each on a device of its own, as one: a batch is cut into pieces,
/// and each device takes the next piece when it has done its last. Answers have their places whoever gives
/// them, so that they are the same bits as those of one device where the devices' arithmetic is the same.
/// Each device holds all structures.
class SharedEvaluator : public Evaluator {
 public:
  /// @param shares one or more.
  explicit SharedEvaluator(std::vector<DeviceShare> shares);
  ~SharedEvaluator() override;

  /// Whoever is free begins at once. Waiting throws what a device threw; a DeviceError names the device.
  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override;
  std::unique_ptr<PendingDensities> start_at(const std::vector<Query>& queries,
                                             const std::vector<GlintPoint>& points) override;
  void calibrate(std::size_t count, const QuerySource& query, double scale) override;
  std::vector<AutoChoice> choices() const override;
  double error_estimate(const Query& query, double density) const override;

  std::size_t replaced() const override;
  std::string name() const override;
  std::size_t device_bytes() const override;  ///< of all devices together
  double build_seconds() const override;
  double device_seconds() const override;

 private:
  struct Part;
  class Densities;

  std::vector<std::unique_ptr<Part>> parts_;
};

/// The method's evaluator on every device: the method's own on one, a SharedEvaluator on several.
/// @param devices one or more; null where the method needs none. They have to outlive what is made.
std::unique_ptr<Evaluator> make_on(const std::vector<Device*>& devices, const Method& method,
                                   const Surface* surface, const MethodSettings& settings);

}  // namespace mica::host
