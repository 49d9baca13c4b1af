// Leaves out heartbeats that nobody needs. Fast DDS 2.9.1 asks each reader for an acknowledgement some milliseconds
// after each sample, and each reader answers. A writer that writes one sample for each state writes the next one about
// then, so heartbeats and their answers are two of three datagrams. They are needed where a sample was lost: then a
// reader waits for it, and soon the writer waits for the reader and falls silent. Pure; time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "rtps/peer.h"

namespace aurasim::rtps {

/// Addressed by a heartbeat.
struct Heartbeat {
  std::uint32_t writer = 0;
  std::uint32_t reader = 0;  ///< entity id; 0: all readers
};

/// The heartbeat of a datagram that asks for acknowledgements and has nothing else in it. Proofs of life ask for none.
std::optional<Heartbeat> heartbeat_in(std::span<const std::uint8_t> datagram);

class HeartbeatLimit {
 public:
  using Time = std::chrono::nanoseconds;  ///< time of any monotonic clock

  /// A writer that writes steadily, of this process; `writer` is its entity id.
  void add_writer(std::uint32_t writer) { writers_.try_emplace(writer); }
  void remove_writer(std::uint32_t writer);

  /// Takes note of a sample that is being sent, be it for the first time or not.
  void note_sent(std::uint32_t writer, std::uint64_t number, Time now);
  /// Takes note that a reader asks for samples of `writer` that it lacks.
  void note_loss(std::uint32_t writer, Time now);
  /// True if the heartbeat is to be sent to `peer`; it then counts as sent. Heartbeats of other writers always are.
  bool allows(const Heartbeat& heartbeat, const Peer& peer, Time now);

  /// A heartbeat is sent after so many samples at the latest, because writers keep what is not acknowledged.
  static constexpr std::uint64_t kMostUnasked = 8;
  /// A writer has fallen silent when its last sample is older than this, and than twice the time between its last two.
  static constexpr Time kSilence = std::chrono::milliseconds(5), kLongestSilence = std::chrono::milliseconds(200);
  /// After a loss all heartbeats are sent for so long: where one sample was lost, others will be.
  static constexpr Time kAfterLoss = std::chrono::seconds(10);
  static constexpr std::size_t kMostReaders = 4096;

 private:
  struct Steady {
    std::uint64_t last = 0;  ///< number of the newest sample
    Time at{0};              ///< when that was sent first
    Time apart{0};           ///< time between the last two
    std::optional<Time> lossy_until;
    std::map<std::pair<Peer, std::uint32_t>, std::uint64_t>
        asked;  ///< by peer and reader: `last` at the last heartbeat
  };
  std::unordered_map<std::uint32_t, Steady> writers_;
};

}  // namespace aurasim::rtps
