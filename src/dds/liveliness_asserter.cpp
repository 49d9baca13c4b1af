#include "dds/liveliness_asserter.h"

#include <algorithm>
#include <utility>

#include <fastdds/dds/publisher/DataWriter.hpp>

#include "core/progress.h"

namespace aurasim::dds {

LivelinessAsserter::LivelinessAsserter(std::chrono::nanoseconds hang_limit, std::function<void()> show_life)
    : hang_limit_(hang_limit),
      show_life_(std::move(show_life)),
      last_progress_ns_(now_ns()),
      thread_([this] { run(); }) {}

LivelinessAsserter::~LivelinessAsserter() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  condition_.notify_one();
  thread_.join();
}

void LivelinessAsserter::add(eprosima::fastdds::dds::DataWriter* writer, std::chrono::nanoseconds lease,
                             const Nanoseconds* written) {
  progress();
  {
    const std::lock_guard lock(mutex_);
    writers_.push_back({writer, lease, written});
    interval_ = std::min(interval_, lease / 4);
  }
  condition_.notify_one();
}

void LivelinessAsserter::remove(eprosima::fastdds::dds::DataWriter* writer) {
  const std::lock_guard lock(mutex_);
  std::erase_if(writers_, [writer](const Renewed& one) { return one.writer == writer; });
}

void LivelinessAsserter::progress() { last_progress_ns_.store(now_ns(), std::memory_order_relaxed); }

void LivelinessAsserter::run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    look_at_computation();
    if (!owner_hangs()) {
      if (show_life_) show_life_();
      for (Renewed& one : writers_) renew(one);
    }
    condition_.wait_for(lock, interval_);
  }
}

void LivelinessAsserter::renew(Renewed& one) const {
  const std::int64_t now = now_ns();
  if (one.written != nullptr) {
    const std::int64_t proved = std::max(one.written->load(std::memory_order_relaxed), one.renewed_ns);
    if (now - proved < one.lease.count() * 3 / 8) return;
  }
  one.writer->assert_liveliness();
  one.renewed_ns = now;
}

void LivelinessAsserter::look_at_computation() {
  const std::uint64_t marks = core::Progress::marks();
  if (marks != marks_) progress();
  marks_ = marks;
}

bool LivelinessAsserter::owner_hangs() const {
  return now_ns() - last_progress_ns_.load(std::memory_order_relaxed) > hang_limit_.count();
}

std::int64_t LivelinessAsserter::now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }

}  // namespace aurasim::dds
