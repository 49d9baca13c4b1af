// When Fast DDS may see datagrams. It receives in one thread per socket, and not everything in it bears that.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <shared_mutex>

namespace aurasim::dds {

/// Thread-safe. Who waits to stop it gets its turn, however much comes.
class Delivery {
 public:
  struct Running {
    std::shared_lock<std::shared_mutex> running;
    std::unique_lock<std::mutex> alone;
  };
  /// Held while Fast DDS sees a datagram. `alone`: of those that are, it sees one at a time.
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

  /// Held while an endpoint is made or removed: Fast DDS 2.9.1 goes through its list of readers, without a lock, when a
  /// datagram says that a writer lives (WLP::sub_liveliness_changed). Not to be asked for by what a datagram has
  /// called.
  [[nodiscard]] std::unique_lock<std::shared_mutex> stop() {
    const std::lock_guard turn(turn_);
    return std::unique_lock(running_);
  }

  struct Reopen {
    void operator()(Delivery* delivery) const { delivery->open(); }
  };
  /// As long as this is there datagrams wait, in their order, most of them in their sockets. For a participant that is
  /// being made: Fast DDS 2.9.1 announces it before it takes what comes (RTPSParticipantImpl::enable), and what others
  /// answer at once was lost. A handshake that is lost comes again after a second.
  [[nodiscard]] std::unique_ptr<Delivery, Reopen> close() {
    const std::lock_guard lock(open_mutex_);
    is_open_ = false;
    return std::unique_ptr<Delivery, Reopen>(this);
  }
  /// Sooner than that.
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

}  // namespace aurasim::dds
