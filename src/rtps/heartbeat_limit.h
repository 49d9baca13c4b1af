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

#include "rtps/datagram_findings.h"
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
  /// Takes note of what a reader has said that it has and lacks.
  void note_request(const Request& request, Time now);
  /// True if the heartbeat is to be sent to `peer`; it then counts as sent. Heartbeats of other writers always are.
  bool allows(const Heartbeat& heartbeat, const Peer& peer, Time now);

  /// A heartbeat is sent after so many samples at the latest, because writers keep what is not acknowledged.
  static constexpr std::uint64_t kMostUnasked = 8;
  /// A writer has fallen silent when its last sample is older than this, and than twice the longest time between two of
  /// late. On a busy host states come irregularly. One long time, as before the start or in a pause, only doubles what
  /// counts.
  static constexpr Time kSilence = std::chrono::milliseconds(5), kLongestSilence = std::chrono::milliseconds(200);
  /// A silent writer asks again after twice as long each time, up to this: who does not answer has no processor now.
  static constexpr Time kLongestPause = std::chrono::milliseconds(500);
  /// After a loss all heartbeats are sent for so long: where one sample was lost, others will be.
  static constexpr Time kAfterLoss = std::chrono::seconds(10);
  static constexpr std::size_t kMostReaders = 4096;

 private:
  /// The last heartbeat to a reader.
  struct Asked {
    std::uint64_t last = 0;  ///< the newest sample then
    Time at{0};
    int repeats = 0;  ///< how often it was asked for the same sample before
  };
  struct Steady {
    std::uint64_t last = 0;  ///< number of the newest sample
    Time at{0};              ///< when that was sent first
    Time apart{0};           ///< longest time between two of late
    std::optional<Time> lossy_until;
    std::map<std::pair<Peer, std::uint32_t>, Asked> asked;  ///< by peer and reader
    /// By reader: the newest sample when it acknowledged something for the first time. What it lacks of those up to
    /// this one was sent before it knew the writer, and is no loss.
    std::map<WireGuid, std::uint64_t> met;
  };
  std::unordered_map<std::uint32_t, Steady> writers_;
};

}  // namespace aurasim::rtps
