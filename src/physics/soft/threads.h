// The threads of a step. Who does what never changes a bit: nothing that is computed by one is read by another before
// all have waited for each other.
#pragma once

#include <cstddef>
#include <utility>

#include <omp.h>

namespace aurasim::physics::soft {

/// One of those that do the same work side by side.
struct Worker {
  int number = 0;
  int of = 1;

  /// Its part of what is counted from 0.
  std::pair<std::size_t, std::size_t> share(std::size_t count) const {
    const auto n = static_cast<std::size_t>(number), all = static_cast<std::size_t>(of);
    return {count * n / all, count * (n + 1) / all};
  }
  bool is_first() const { return number == 0; }
  /// Of the others; all call it.
  void wait() const {
    if (of == 1) return;
#pragma omp barrier
  }
};

/// work(Worker), by at most `threads` at once.
template <class Work>
void side_by_side(int threads, Work&& work) {
  if (threads == 1) return work(Worker{});
#pragma omp parallel num_threads(threads)
  work(Worker{omp_get_thread_num(), omp_get_num_threads()});
}

/// work(i) for each i below `count`, in no order.
template <class Work>
void for_each_side_by_side(int threads, std::size_t count, Work&& work) {
  side_by_side(threads, [&](const Worker& worker) {
    const auto [first, last] = worker.share(count);
    for (std::size_t i = first; i < last; ++i) work(i);
  });
}

}  // namespace aurasim::physics::soft
