// Counts the work that this process gets done, so that a long computation can be distinguished from a hang. Core and
// physics have no clock, so they only count. dds/liveliness_asserter.h has a clock and watches whether the count grows.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace aurasim::core {

/// One count for the whole process, because liveliness is that of a process. Any thread may call it.
class Progress {
 public:
  /// Marks that a part of a computation is done. Between two marks there is work for a second at most, whatever the
  /// scene: loops whose length grows faster than the number of bodies call this inside.
  static void mark() { marks_.fetch_add(1, std::memory_order_relaxed); }
  /// Marks every 16th turn of a loop whose single turns are short.
  static void mark_now_and_then(std::size_t turn) {
    if (turn % 16 == 0) mark();
  }
  static std::uint64_t marks() { return marks_.load(std::memory_order_relaxed); }

 private:
  inline static std::atomic<std::uint64_t> marks_{0};
};

}  // namespace aurasim::core
