// When Fast DDS may see datagrams. It receives in one thread per socket, and not everything in it bears that.
#pragma once

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

 private:
  std::mutex turn_, alone_;
  std::shared_mutex running_;
};

}  // namespace aurasim::dds
