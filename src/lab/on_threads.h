// The same work on several threads.
#pragma once

#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace aurasim::lab {

/// Calls `work` on each of `threads` threads and waits for all. If threads throw, one of their exceptions is thrown
/// here.
template <class Work>
void on_threads(int threads, const Work& work) {
  std::exception_ptr failure;
  std::mutex failure_mutex;
  std::vector<std::jthread> workers;
  for (int i = 0; i < threads; ++i) {
    workers.emplace_back([&] {
      try {
        work();
      } catch (...) {
        const std::lock_guard lock(failure_mutex);
        failure = std::current_exception();
      }
    });
  }
  workers.clear();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace aurasim::lab
