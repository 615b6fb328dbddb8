#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>

#include "mica/version.h"

MICA_BEGIN_NAMESPACE

/// Tells work that runs elsewhere to stop. Copies are the same token; any thread may cancel.
class CancellationToken {
 public:
  void cancel() { cancelled_->store(true); }
  bool is_cancelled() const { return cancelled_->load(); }

 private:
  std::shared_ptr<std::atomic<bool>> cancelled_ = std::make_shared<std::atomic<bool>>(false);
};

/// What a caller hears of long work, and says to it.
struct RunControl {
  /// Called now and then on the calling thread; what it throws passes through, and nothing is left half done.
  std::function<void(std::size_t done, std::size_t all)> progress;
  /// Work that is cancelled throws Cancelled, within about a second.
  CancellationToken cancellation;
};

MICA_END_NAMESPACE
