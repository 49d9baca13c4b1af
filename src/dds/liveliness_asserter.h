// Asserts the liveliness of a process: renews its writers' liveliness while their owner makes progress. Progress is a
// call of a transport or a bus, or a mark of a long computation (core/progress.h). So a long step does not count as a
// death, but a process that hangs does.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace eprosima::fastdds::dds {
class DataWriter;
}

namespace aurasim::dds {

class LivelinessAsserter {
 public:
  /// `hang_limit`: longest time without progress. `show_life`: called by the asserter's thread whenever it renews
  /// writers; may be empty.
  explicit LivelinessAsserter(std::chrono::nanoseconds hang_limit, std::function<void()> show_life = {});
  ~LivelinessAsserter();

  using Nanoseconds = std::atomic<std::int64_t>;  ///< of now_ns()

  /// Renews `writer` every `lease` / 4 from now on. With `written`, the time of its last sample, which is a proof of
  /// life, too: only if the last proof is older than 3/8 of the lease, so every half lease at most.
  void add(eprosima::fastdds::dds::DataWriter* writer, std::chrono::nanoseconds lease,
           const Nanoseconds* written = nullptr);
  /// Stops renewing `writer`. After the return it is not touched any more.
  void remove(eprosima::fastdds::dds::DataWriter* writer);

  /// Marks progress of the owner. Callable from any thread.
  void progress();

  static std::int64_t now_ns();

 private:
  struct Renewed {
    eprosima::fastdds::dds::DataWriter* writer = nullptr;
    std::chrono::nanoseconds lease{0};
    const Nanoseconds* written = nullptr;
    std::int64_t renewed_ns = 0;
  };

  void renew(Renewed& one) const;
  void run();
  void look_at_computation();
  bool owner_hangs() const;

  const std::chrono::nanoseconds hang_limit_;
  const std::function<void()> show_life_;
  std::atomic<std::int64_t> last_progress_ns_;
  std::mutex mutex_;
  std::condition_variable condition_;
  bool stopping_ = false;
  std::chrono::nanoseconds interval_ = std::chrono::milliseconds(250);
  std::vector<Renewed> writers_;
  std::uint64_t marks_ = 0;  ///< value of core::Progress at the last look
  std::thread thread_;       // last: starts when all else is there
};

}  // namespace aurasim::dds
