#include "dds/delay_line.h"

#include <chrono>
#include <utility>

#include <fastdds/rtps/common/LocatorsIterator.hpp>
#include <fastrtps/utils/IPLocator.h>

namespace aurasim::dds {

using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::octet;
using eprosima::fastrtps::rtps::SenderResource;
using Clock = std::chrono::steady_clock;

namespace {

/// A full socket may hold the sender up for this long; then the datagram is lost.
constexpr std::chrono::milliseconds kLongestBlocking{100};

/// A locator list with one destination.
class OneLocator final : public eprosima::fastdds::rtps::LocatorsIterator {
 public:
  explicit OneLocator(const Locator_t* position) : position_(position) {}
  LocatorsIterator& operator++() override {
    ++position_;
    return *this;
  }
  bool operator==(const LocatorsIterator& other) const override {
    return position_ == static_cast<const OneLocator&>(other).position_;
  }
  bool operator!=(const LocatorsIterator& other) const override { return !(*this == other); }
  const Locator_t& operator*() const override { return *position_; }

 private:
  const Locator_t* position_;
};

bool send_now(SenderResource& socket, const octet* bytes, std::uint32_t size, const Locator_t& destination) {
  OneLocator begin(&destination), end(&destination + 1);
  return socket.send(bytes, size, &begin, &end, Clock::now() + kLongestBlocking);
}

ImpairedLink::Time now() { return Clock::now().time_since_epoch(); }

/// Combines address and port into one number.
std::uint64_t number_of(const Locator_t& locator) {
  const octet* address = IPLocator::getIPv4(locator);
  std::uint64_t number = locator.port;
  for (int i = 0; i < 4; ++i) number = number << 8 | address[i];
  return number;
}

}  // namespace

DelayLine::DelayLine(const Impairment& impairment, std::uint64_t stream, MetatrafficPorts ports)
    : impairment_(impairment), ports_(std::move(ports)), link_(impairment, stream) {
  if (impairment_.delays()) thread_ = std::thread([this] { run(); });
}

DelayLine::~DelayLine() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

/// Decides on a datagram, and queues it if it has to wait. One critical section covers both, so that the order of
/// decisions is the order in the queue.
ImpairedLink::Fate DelayLine::offer(SenderResource& socket, const octet* bytes, std::uint32_t size,
                                    const Locator_t& destination) {
  const bool spared =
      !impairment_.discovery && ports_.is_discovery(IPLocator::isMulticast(destination), destination.port);
  const std::lock_guard lock(mutex_);
  if (stopped_ || spared) {
    link_.spare();
    return ImpairedLink::Fate::kLeavesNow;
  }
  const auto [fate, due] = link_.offer(now(), number_of(destination), size);
  if (fate == ImpairedLink::Fate::kWaits) {
    const bool first = queue_.empty() || due < queue_.top().due;
    queue_.push({due, next_sequence_++, &socket, destination, {bytes, bytes + size}});
    if (first) changed_.notify_all();
  }
  return fate;
}

bool DelayLine::send(SenderResource& socket, const octet* bytes, std::uint32_t size, const Locator_t& destination) {
  if (offer(socket, bytes, size, destination) != ImpairedLink::Fate::kLeavesNow) return true;
  const std::lock_guard lock(wire_);
  return send_now(socket, bytes, size, destination);
}

bool DelayLine::pop_until(ImpairedLink::Time last_due, Datagram& next) {
  const std::lock_guard lock(mutex_);
  if (queue_.empty() || queue_.top().due > last_due) return false;
  next = std::move(const_cast<Datagram&>(queue_.top()));  // the order looks at due and sequence, which stay
  queue_.pop();
  link_.leave(next.bytes.size());
  return true;
}

void DelayLine::send_until(ImpairedLink::Time last_due) {
  const std::lock_guard lock(wire_);
  for (Datagram next; pop_until(last_due, next);) {
    send_now(*next.socket, next.bytes.data(), static_cast<std::uint32_t>(next.bytes.size()), next.destination);
  }
}

void DelayLine::run() {
  std::unique_lock lock(mutex_);
  while (!stopped_) {
    if (queue_.empty()) {
      changed_.wait(lock);
    } else if (const auto due = queue_.top().due; due > now()) {
      changed_.wait_until(lock, Clock::time_point(due));
    } else {
      lock.unlock();
      send_until(now());
      lock.lock();
    }
  }
}

void DelayLine::flush() { send_until(ImpairedLink::Time::max()); }

void DelayLine::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  flush();
}

ImpairmentCounters DelayLine::counters() const {
  const std::lock_guard lock(mutex_);
  return link_.counters();
}

}  // namespace aurasim::dds
