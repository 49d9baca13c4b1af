// The threads of a step. Their number never changes a bit: no thread reads what another computes before all have waited
// for each other.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace aurasim::physics::soft {

class Team;

/// Number of cores that this process may use, at least 1.
int usable_cores();

/// Tells the core that the thread only waits.
inline void pause() {
#ifdef __x86_64__
  __builtin_ia32_pause();
#endif
}

/// One of several threads that share the same work.
struct Worker {
  int number = 0;
  int of = 1;
  Team* team = nullptr;

  /// This worker's range [first, last) of `count` items.
  std::pair<std::size_t, std::size_t> share(std::size_t count) const {
    const auto n = static_cast<std::size_t>(number), all = static_cast<std::size_t>(of);
    return {count * n / all, count * (n + 1) / all};
  }
  bool is_first() const { return number == 0; }
  /// Waits until all workers have called it.
  inline void wait() const;
};

/// The threads of one world. They start when there is work for them first. A thread that waits
/// within a step looks again and again for some 1 ms, then it sleeps; between steps it sleeps at once. Where
/// the first thread waits for others for more than half of a step, because other processes have the cores, it computes
/// the next steps alone.
class Team {
 public:
  /// At most `threads` threads, with the one that calls.
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// Number of threads that work, at most.
  int size() const { return size_; }
  /// Number of threads that work now.
  int employed() const { return employed_; }
  /// Begins a step: chooses how many threads work in it. With few bodies the threads would wait for each other longer
  /// than they work.
  void employ_for(std::size_t bodies);
  /// Ends a step: lets the other threads sleep at once until the next job.
  void rest();

  /// Calls work(Worker) in all employed threads at once. Returns when all are done.
  template <class Work>
  void side_by_side(Work&& work) {
    if (employed_ == 1) return work(Worker{});
    run([](void* job, const Worker& worker) { (*static_cast<std::remove_reference_t<Work>*>(job))(worker); }, &work);
  }
  /// Calls work(i) for each i below `count`, in no order.
  template <class Work>
  void for_each(std::size_t count, Work&& work) {
    side_by_side([&](const Worker& worker) {
      const auto [first, last] = worker.share(count);
      for (std::size_t i = first; i < last; ++i) work(i);
    });
  }

  /// Number of times that all threads have waited for each other.
  std::uint32_t waits() const { return waits_.load(std::memory_order_relaxed); }

 private:
  friend struct Worker;
  using Call = void (*)(void* job, const Worker& worker);
  using Clock = std::chrono::steady_clock;

  void run(Call call, const void* job);
  void serve(int number);
  void wait(const Worker& worker);
  void change(std::atomic<std::uint32_t>& word, std::uint32_t to);
  /// Adds the time of a wait that is not short to `waited`, if given.
  void await_change(const std::atomic<std::uint32_t>& word, std::uint32_t from, Clock::duration* waited);

  int size_;
  int employed_ = 1;
  int spins_;
  int steps_alone_ = 0;       ///< so many steps are still computed by one thread
  int steps_alone_next_;      ///< so many will be, when the first thread has waited too long again
  Clock::time_point begun_;   ///< of the present step
  Clock::duration waited_{};  ///< by the first thread, in the present step
  Call call_ = nullptr;
  void* job_ = nullptr;
  /// Number of the job, times kMostThreads, plus the number of threads that work on it. 0: the team is dismissed.
  alignas(64) std::atomic<std::uint32_t> start_{1};
  std::atomic<bool> rests_{false};
  alignas(64) std::atomic<std::uint32_t> arrived_{0};  ///< threads that wait for the others
  alignas(64) std::atomic<std::uint32_t> waits_{0};
  std::atomic<int> sleepers_{0};
  std::vector<std::thread> threads_;
};

/// Items in a list that threads share while they work, because some items take far longer than others. Each thread goes
/// through its own share in order, piece by piece, and then helps with the shares of others: memory that is read in
/// order comes sooner, and in the next step most of it is still near the same core.
class Pieces {
 public:
  /// For teams of at most `threads`.
  explicit Pieces(int threads) : shares_(std::make_unique<Share[]>(static_cast<std::size_t>(threads))) {}

  /// Begins with `count` items, for `workers`, in pieces of `size` items at most.
  void begin(std::size_t count, int workers, std::size_t size) {
    size_ = size;
    for (int i = 0; i < workers; ++i) {
      Share& share = shares_[static_cast<std::size_t>(i)];
      const auto [first, last] = Worker{i, workers, nullptr}.share(count);
      share.next.store(first, std::memory_order_relaxed);
      share.last = last;
    }
  }
  /// Calls work(first, last) for pieces until all have been taken.
  template <class Work>
  void work_off(const Worker& worker, Work&& work) {
    for (int i = 0; i < worker.of; ++i) {
      Share& share = shares_[static_cast<std::size_t>((worker.number + i) % worker.of)];
      while (true) {
        const std::size_t first = share.next.fetch_add(size_, std::memory_order_relaxed);
        if (first >= share.last) break;
        work(first, std::min(share.last, first + size_));
      }
    }
  }

 private:
  struct alignas(64) Share {
    std::atomic<std::size_t> next{0};
    std::size_t last = 0;
  };

  std::size_t size_ = 1;
  std::unique_ptr<Share[]> shares_;  ///< by thread
};

inline void Worker::wait() const {
  if (of > 1) team->wait(*this);
}

}  // namespace aurasim::physics::soft
