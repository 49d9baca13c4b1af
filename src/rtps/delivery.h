// Controls when Fast DDS may process datagrams. It receives in one thread per socket, and some of its code does not
// allow that.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <shared_mutex>

namespace aurasim::rtps {

/// Thread-safe. A thread that waits in stop() gets its turn, however many datagrams come.
class Delivery {
 public:
  struct Running {
    std::shared_lock<std::shared_mutex> running;
    std::unique_lock<std::mutex> alone;
  };
  /// Returns a lock to hold while Fast DDS processes a datagram. `alone`: of the datagrams with this flag, Fast DDS
  /// processes one at a time.
  [[nodiscard]] Running begin(bool alone) {
    wait_until_open();
    Running held;
    {
      const std::lock_guard turn(turn_);
      held.running = std::shared_lock(running_);
    }
    if (alone) held.alone = std::unique_lock(alone_);
    return held;
  }

  /// Returns a lock to hold while an endpoint is created or removed. When a datagram renews a writer's liveliness, Fast
  /// DDS 2.9.1 iterates over its readers without a lock (WLP::sub_liveliness_changed). Must not be called from the
  /// processing of a datagram: that deadlocks.
  [[nodiscard]] std::unique_lock<std::shared_mutex> stop() {
    const std::lock_guard turn(turn_);
    return std::unique_lock(running_);
  }

  struct Reopen {
    void operator()(Delivery* delivery) const { delivery->open(); }
  };
  /// Datagrams wait, in order, while the returned object exists; most of them wait in their sockets. Needed while a
  /// participant is created: Fast DDS 2.9.1 announces it before it receives (RTPSParticipantImpl::enable), and answers
  /// that came at once were lost. A lost handshake is repeated only after a second.
  [[nodiscard]] std::unique_ptr<Delivery, Reopen> close() {
    const std::lock_guard lock(open_mutex_);
    is_open_ = false;
    return std::unique_ptr<Delivery, Reopen>(this);
  }
  /// Lets datagrams through again before the object that close() returned is destroyed.
  void open() {
    {
      const std::lock_guard lock(open_mutex_);
      is_open_ = true;
    }
    opened_.notify_all();
  }

 private:
  static constexpr std::chrono::seconds kLongestClosed{5};

  void wait_until_open() {
    std::unique_lock lock(open_mutex_);
    opened_.wait_for(lock, kLongestClosed, [this] { return is_open_; });
  }

  std::mutex turn_, alone_, open_mutex_;
  std::shared_mutex running_;
  std::condition_variable opened_;
  bool is_open_ = true;
};

}  // namespace aurasim::rtps
