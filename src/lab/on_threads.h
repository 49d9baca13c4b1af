// Pieces of work on several threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <vector>

namespace aurasim::lab {

/// Called with the share of the work that is done, 0 to 1. If it returns false, the work ends early.
using Progress = std::function<bool(double share)>;

/// One piece of work, as its thread sees it.
struct WorkPiece {
  std::size_t index = 0;
  const std::atomic<bool>& stop;                   ///< the work is to end early
  const std::function<void(double share)>& shown;  ///< to be called in a long piece with the share of it that is done
};

/// Calls `work` for each piece, in ascending order, on `threads` threads. `costs`: estimated cost of each piece, in any
/// unit. `progress` is called by one thread at a time. Returns false if the work ended early. If threads throw, one of
/// their exceptions is thrown here.
bool on_threads(int threads, const std::vector<double>& costs, const Progress& progress,
                const std::function<void(const WorkPiece&)>& work);

}  // namespace aurasim::lab
