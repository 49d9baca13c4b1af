#include "lab/on_threads.h"

#include <exception>
#include <mutex>
#include <numeric>
#include <thread>

namespace aurasim::lab {
namespace {

/// Adds up what the threads have done.
class Share {
 public:
  Share(const std::vector<double>& costs, const Progress& progress)
      : costs_(costs),
        done_(costs.size(), 0),
        whole_(std::accumulate(costs.begin(), costs.end(), 0.0)),
        progress_(progress) {}

  /// False if the work is to end.
  bool add(std::size_t piece, double share) {
    const std::lock_guard lock(mutex_);
    sum_ += (share - done_[piece]) * costs_[piece];
    done_[piece] = share;
    return progress_(sum_ / whole_);
  }

 private:
  std::mutex mutex_;
  const std::vector<double>& costs_;
  std::vector<double> done_;
  double sum_ = 0, whole_ = 0;
  const Progress& progress_;
};

}  // namespace

bool on_threads(int threads, const std::vector<double>& costs, const Progress& progress,
                const std::function<void(const WorkPiece&)>& work) {
  std::atomic<bool> stop = false;
  std::atomic<std::size_t> next = 0;
  Share share(costs, progress);
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work_on = [&] {
    for (std::size_t i = next++; i < costs.size() && !stop; i = next++) {
      const std::function<void(double)> shown = [&share, &stop, i](double of_piece) {
        if (!share.add(i, of_piece)) stop = true;
      };
      work({i, stop, shown});
      if (!stop) shown(1);
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < threads; ++i) {
      workers.emplace_back([&] {
        try {
          work_on();
        } catch (...) {
          const std::lock_guard lock(failure_mutex);
          failure = std::current_exception();
        }
      });
    }
  }
  if (failure) std::rethrow_exception(failure);
  return !stop;
}

}  // namespace aurasim::lab
