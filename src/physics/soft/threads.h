// The threads of a step. Their number never changes a bit: no thread reads what another computes before all have waited
// for each other.
#pragma once

#include <cstddef>
#include <utility>

#include <omp.h>

namespace aurasim::physics::soft {

/// One of several threads that share the same work.
struct Worker {
  int number = 0;
  int of = 1;

  /// This worker's range [first, last) of `count` items.
  std::pair<std::size_t, std::size_t> share(std::size_t count) const {
    const auto n = static_cast<std::size_t>(number), all = static_cast<std::size_t>(of);
    return {count * n / all, count * (n + 1) / all};
  }
  bool is_first() const { return number == 0; }
  /// Waits until all workers have called it.
  void wait() const {
    if (of == 1) return;
#pragma omp barrier
  }
};

/// Calls work(Worker) in up to `threads` threads at once.
template <class Work>
void side_by_side(int threads, Work&& work) {
  if (threads == 1) return work(Worker{});
#pragma omp parallel num_threads(threads)
  work(Worker{omp_get_thread_num(), omp_get_num_threads()});
}

/// Calls work(i) for each i below `count`, in no order.
template <class Work>
void for_each_side_by_side(int threads, std::size_t count, Work&& work) {
  side_by_side(threads, [&](const Worker& worker) {
    const auto [first, last] = worker.share(count);
    for (std::size_t i = first; i < last; ++i) work(i);
  });
}

}  // namespace aurasim::physics::soft
