#include "physics/soft/threads.h"

#include <algorithm>
#include <optional>

#include <linux/futex.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace aurasim::physics::soft {
namespace {

constexpr std::uint32_t kMostThreads = 128;
/// A thread with fewer bodies costs more than it saves.
constexpr std::size_t kBodiesOfThread = 32;
/// How often a waiting thread looks again before it sleeps: some 1 ms. What one thread computes alone in a step rarely
/// takes longer. A thread that sleeps where another process wants the core, too, may have to wait for a slice of it
/// (some 3 ms). For the same reason it does not yield the core.
constexpr int kSpins = 40000;
/// Waits of fewer looks are not timed, because reading the clock takes as long as some looks.
constexpr int kShortWait = 2000;
/// Steps that the first thread computes alone when it has waited too long. Twice as many each time, until it has not.
constexpr int kFewestAlone = 60, kMostAlone = 960;

/// Sleeps until wake_all() for the same word, unless it is not `from` any more. May return earlier.
void sleep_while(const std::atomic<std::uint32_t>& word, std::uint32_t from) {
  syscall(SYS_futex, &word, FUTEX_WAIT_PRIVATE, from, nullptr, nullptr, 0);
}
void wake_all(const std::atomic<std::uint32_t>& word) {
  syscall(SYS_futex, &word, FUTEX_WAKE_PRIVATE, 1 << 30, nullptr, nullptr, 0);
}

}  // namespace

int usable_cores() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof(set), &set) == 0 ? std::max(1, CPU_COUNT(&set)) : 1;
}

Team::Team(int threads)
    : size_(std::clamp(threads, 1, static_cast<int>(kMostThreads) - 1)),
      employed_(size_),
      spins_(threads <= usable_cores() ? kSpins : 0),
      steps_alone_next_(kFewestAlone) {}

Team::~Team() {
  change(start_, 0);
  for (std::thread& thread : threads_) thread.join();
}

void Team::employ_for(std::size_t bodies) {
  employed_ = static_cast<int>(std::clamp<std::size_t>(bodies / kBodiesOfThread, 1, static_cast<std::size_t>(size_)));
  if (steps_alone_ > 0) {
    --steps_alone_;
    employed_ = 1;
  }
  begun_ = Clock::now();
  waited_ = {};
}

void Team::rest() {
  rests_.store(true, std::memory_order_relaxed);
  if (employed_ == 1) return;
  if (2 * waited_ > Clock::now() - begun_) {
    steps_alone_ = steps_alone_next_;
    steps_alone_next_ = std::min(2 * steps_alone_next_, kMostAlone);
  } else {
    steps_alone_next_ = kFewestAlone;
  }
}

void Team::run(Call call, const void* job) {
  while (static_cast<int>(threads_.size()) + 1 < employed_) {
    const int number = static_cast<int>(threads_.size()) + 1;
    threads_.emplace_back([this, number] { serve(number); });
  }
  rests_.store(false, std::memory_order_relaxed);
  call_ = call;
  job_ = const_cast<void*>(job);
  const std::uint32_t number = start_.load(std::memory_order_relaxed) / kMostThreads;
  change(start_, (number + 1) * kMostThreads + static_cast<std::uint32_t>(employed_));
  const Worker worker{0, employed_, this};
  call(job_, worker);
  worker.wait();
}

/// Works on all jobs for which the thread is employed.
void Team::serve(int number) {
  std::uint32_t seen = 1;
  while (true) {
    await_change(start_, seen, nullptr);
    seen = start_.load(std::memory_order_acquire);
    if (seen == 0) return;
    const Worker worker{number, static_cast<int>(seen % kMostThreads), this};
    if (number >= worker.of) continue;
    call_(job_, worker);
    worker.wait();
  }
}

void Team::wait(const Worker& worker) {
  const std::uint32_t before = waits_.load(std::memory_order_relaxed);
  if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == static_cast<std::uint32_t>(worker.of)) {
    arrived_.store(0, std::memory_order_relaxed);
    change(waits_, before + 1);
  } else {
    await_change(waits_, before, worker.is_first() ? &waited_ : nullptr);
  }
}

/// Changes a word for all that wait for it.
void Team::change(std::atomic<std::uint32_t>& word, std::uint32_t to) {
  word.store(to);  // sequentially consistent, as sleepers_: either this sees the sleeper, or it sees the change
  if (sleepers_.load() > 0) wake_all(word);
}

void Team::await_change(const std::atomic<std::uint32_t>& word, std::uint32_t from, Clock::duration* waited) {
  std::optional<Clock::time_point> since;
  const auto has_changed = [&] { return word.load(std::memory_order_acquire) != from; };
  bool changed = has_changed();
  for (int i = 0; !changed && i < spins_ && !rests_.load(std::memory_order_relaxed); ++i) {
    if (i == kShortWait && waited != nullptr) since = Clock::now();
    pause();
    changed = has_changed();
  }
  if (!changed) {
    if (!since && waited != nullptr) since = Clock::now();
    ++sleepers_;
    while (word.load() == from) sleep_while(word, from);
    --sleepers_;
  }
  if (since) *waited += Clock::now() - *since;
}

}  // namespace aurasim::physics::soft
