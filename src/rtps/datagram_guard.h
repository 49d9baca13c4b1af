// Filters datagrams between the sockets and Fast DDS: passes what datagram_check.h and peer_book.h allow, and counts
// the rest. Knows nothing of Fast DDS; wire_transport.h applies it. Two things are never passed to Fast DDS, because it
// forgets them too late or too early and then ends the process (DataReaderHistory.cpp:822): fragments of a sample, and
// the end of an instance.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "rtps/datagram_findings.h"
#include "rtps/delivery.h"
#include "rtps/discovery_fragments.h"
#include "rtps/guard_report.h"
#include "rtps/heartbeat_limit.h"
#include "rtps/made_datagrams.h"
#include "rtps/peer_book.h"
#include "rtps/repeats.h"
#include "rtps/source_limits.h"

namespace aurasim::rtps {

struct GuardLimits {
  RateLimits rates;
  PeerLimits peers;
  RepeatLimits repeats;
};

/// Thread-safe.
class DatagramGuard {
 public:
  using Time = core::TokenBucket::Time;  ///< time of any monotonic clock

  explicit DatagramGuard(const GuardLimits& limits = {})
      : rates_(limits.rates), peers_(limits.peers), repeats_(limits.repeats) {}

  /// Sets the prefix of the own participant. Datagrams for other participants only are not recorded in the peer book,
  /// because Fast DDS here does not see them.
  void set_own(const GuidPrefix& own);
  /// Sets the processes that are nodes of the run, the own one excluded (repeats.h).
  void set_nodes(Repeats::Prefixes nodes);
  /// Registers a writer of this process whose samples only nodes need. `is_steady`: it writes a sample for each state
  /// (heartbeat_limit.h).
  void add_writer_of_nodes(std::uint32_t writer, bool is_steady = false);
  void remove_writer_of_nodes(std::uint32_t writer);
  /// Drops everything that `process` sends from now on, until it is forgiven.
  void shun(const GuidPrefix& process);
  void forgive(const GuidPrefix& process);

  struct Admitted {
    /// Datagrams to pass to Fast DDS before this one. They replace parts of it, such as fragments by the whole sample.
    std::vector<MadeDatagram> before;
    std::size_t size = 0;  ///< number of leading bytes that Fast DDS may see; 0: none
    /// Fast DDS 2.9.1 must not process another such datagram at the same time on another socket. It keeps what it
    /// learns of a new participant in variables that all threads share (SecurityManager's temporaries; fixed in 2.9.2,
    /// #3373). Otherwise one of two participants with keys would never be matched.
    bool is_alone = false;
  };
  /// Decides what of a received datagram Fast DDS may see. Overwrites in `bytes` what Fast DDS must not act on with
  /// padding.
  Admitted admit(std::span<std::uint8_t> bytes, Source source, Time now);
  Delivery& delivery() { return delivery_; }
  /// Takes note of a datagram that this process is about to send.
  void note_sent(std::span<const std::uint8_t> bytes, Time now);
  /// True if a heartbeat of this process is to be sent.
  bool allows(const Heartbeat& heartbeat, const Peer& peer, Time now);

  GuardReport report() const;
  /// Returns the addresses from which something was refused for the first time since the last call.
  std::vector<GuardReport::Address> take_new_sources();
  std::vector<std::pair<GuidPrefix, Repeats::Answer>> take_new_askers();

 private:
  std::optional<Refusal> judge(const Findings& findings, std::span<const std::uint8_t> bytes, Source source, Time now,
                               Admitted& admitted);
  std::optional<Refusal> judge_fragments(const Claim& claim, std::span<const std::uint8_t> bytes, Source source,
                                         Time now, Admitted& admitted);
  bool is_of_shunned(const Findings& findings, const GuidPrefix& sender) const;
  void answer_requests(Findings& findings, Source source, Time now);
  void refuse(Refusal why, Source source);

  Delivery delivery_;
  mutable std::mutex mutex_;
  std::optional<GuidPrefix> own_;
  SourceLimits rates_;
  PeerBook peers_;
  DiscoveryFragments fragments_;
  Repeats repeats_;
  HeartbeatLimit heartbeats_;
  Repeats::Prefixes shunned_;
  GuardReport::Counts refused_{};
  std::uint64_t passed_ = 0;
  std::unordered_map<std::uint32_t, GuardReport::Address> addresses_;
  std::uint64_t of_others_ = 0;  ///< datagrams refused from addresses beyond those counted one by one
  std::vector<std::uint32_t> new_addresses_;
};

}  // namespace aurasim::rtps
