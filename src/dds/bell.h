// Wakes one waiting thread. Rung from DDS threads, which must not be held up.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace aurasim::dds {

class Bell {
 public:
  void ring() {
    {
      const std::lock_guard lock(mutex_);
      rung_ = true;
    }
    condition_.notify_one();
  }

  /// Returns when it was rung since the last wait or quiet, or at the time-out. True when rung.
  bool wait(std::chrono::nanoseconds time_out) {
    std::unique_lock lock(mutex_);
    condition_.wait_for(lock, time_out, [this] { return rung_; });
    return std::exchange(rung_, false);
  }

  /// Forgets earlier rings: the owner is about to look at everything.
  void quiet() {
    const std::lock_guard lock(mutex_);
    rung_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable condition_;
  bool rung_ = false;
};

}  // namespace aurasim::dds
