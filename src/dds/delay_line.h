// Holds back a participant's datagrams until they are due. One thread per participant.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <queue>
#include <thread>
#include <vector>

#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/network/SenderResource.h>

#include "dds/impairment.h"

namespace aurasim::dds {

/// Thread-safe.
class DelayLine {
 public:
  DelayLine(const Impairment& impairment, std::uint64_t stream, MetatrafficPorts ports);
  ~DelayLine();
  DelayLine(const DelayLine&) = delete;
  DelayLine& operator=(const DelayLine&) = delete;

  /// Sends a datagram now, or copies its bytes and sends it later. `socket` must live until stop(). Returns false only
  /// when the socket refused a datagram that was sent at once. A datagram that the impairment loses returns true, as in
  /// any network.
  bool send(eprosima::fastrtps::rtps::SenderResource& socket, const eprosima::fastrtps::rtps::octet* bytes,
            std::uint32_t size, const eprosima::fastrtps::rtps::Locator_t& destination);

  /// Sends all waiting datagrams at once and in order. A process that ends without stop() calls this, or its last
  /// messages would be lost; on a real network they would be under way by then.
  void flush();
  /// Flushes, and sends everything at once from then on. May be called twice.
  void stop();

  ImpairmentCounters counters() const;
  const Impairment& impairment() const { return impairment_; }

 private:
  struct Datagram {
    ImpairedLink::Time due;
    std::uint64_t sequence;
    eprosima::fastrtps::rtps::SenderResource* socket;
    eprosima::fastrtps::rtps::Locator_t destination;
    std::vector<eprosima::fastrtps::rtps::octet> bytes;

    /// Order of the priority queue, whose top is its greatest element: the datagram that leaves first.
    bool operator<(const Datagram& other) const {
      return due != other.due ? due > other.due : sequence > other.sequence;
    }
  };

  ImpairedLink::Fate offer(eprosima::fastrtps::rtps::SenderResource& socket,
                           const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
                           const eprosima::fastrtps::rtps::Locator_t& destination);
  void send_until(ImpairedLink::Time last_due);
  bool pop_until(ImpairedLink::Time last_due, Datagram& next);
  void run();

  const Impairment impairment_;
  const MetatrafficPorts ports_;
  /// Held while a datagram is sent: Fast DDS does not expect two threads in a socket, and a datagram taken from the
  /// queue must not be overtaken. Locked before mutex_.
  std::mutex wire_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stopped_ = false;
  std::uint64_t next_sequence_ = 0;
  std::priority_queue<Datagram> queue_;
  ImpairedLink link_;
  std::thread thread_;  // last: uses all the others
};

}  // namespace aurasim::dds
