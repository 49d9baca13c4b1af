#include "physics/soft/threads.h"

#include <algorithm>

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
      spins_(threads <= usable_cores() ? kSpins : 0) {}

Team::~Team() {
  change(start_, 0);
  for (std::thread& thread : threads_) thread.join();
}

void Team::employ_for(std::size_t bodies) {
  employed_ = static_cast<int>(std::clamp<std::size_t>(bodies / kBodiesOfThread, 1, static_cast<std::size_t>(size_)));
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
    await_change(start_, seen);
    seen = start_.load(std::memory_order_acquire);
    if (seen == 0) return;
    const Worker worker{number, static_cast<int>(seen % kMostThreads), this};
    if (number >= worker.of) continue;
    call_(job_, worker);
    worker.wait();
  }
}

void Team::wait(int of) {
  const std::uint32_t before = waits_.load(std::memory_order_relaxed);
  if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == static_cast<std::uint32_t>(of)) {
    arrived_.store(0, std::memory_order_relaxed);
    change(waits_, before + 1);
  } else {
    await_change(waits_, before);
  }
}

/// Changes a word for all that wait for it.
void Team::change(std::atomic<std::uint32_t>& word, std::uint32_t to) {
  word.store(to);  // sequentially consistent, as sleepers_: either this sees the sleeper, or it sees the change
  if (sleepers_.load() > 0) wake_all(word);
}

void Team::await_change(const std::atomic<std::uint32_t>& word, std::uint32_t from) {
  for (int i = 0; i < spins_ && !rests_.load(std::memory_order_relaxed); ++i) {
    if (word.load(std::memory_order_acquire) != from) return;
    pause();
  }
  ++sleepers_;
  while (word.load() == from) sleep_while(word, from);
  --sleepers_;
}

}  // namespace aurasim::physics::soft
