// Wakes one waiting thread. DDS threads notify it, which must not be held up.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace aurasim::dds {

class Wakeup {
 public:
  void notify() {
    {
      const std::lock_guard lock(mutex_);
      notified_ = true;
    }
    condition_.notify_one();
  }

  /// Returns when it was notified since the last wait or clear, or at the time-out. True when notified.
  bool wait(std::chrono::nanoseconds time_out) {
    std::unique_lock lock(mutex_);
    condition_.wait_for(lock, time_out, [this] { return notified_; });
    return std::exchange(notified_, false);
  }

  /// Forgets earlier notifications. Called by the owner just before it looks at everything.
  void clear() {
    const std::lock_guard lock(mutex_);
    notified_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable condition_;
  bool notified_ = false;
};

}  // namespace aurasim::dds
