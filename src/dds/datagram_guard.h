// Stands between the sockets and Fast DDS: lets through what datagram_check.h and peer_book.h allow, and counts the
// rest. Knows nothing of Fast DDS; wire_transport.h puts it to work. Fast DDS never sees a part of a sample, nor that
// an instance has ended: of both it forgets too late or too early, and ends the process (DataReaderHistory.cpp:822).
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

#include "dds/datagram_findings.h"
#include "dds/delivery.h"
#include "dds/fragment_requests.h"
#include "dds/guard_report.h"
#include "dds/made_datagrams.h"
#include "dds/peer_book.h"
#include "dds/repeats.h"
#include "dds/source_limits.h"

namespace aurasim::dds {

struct GuardLimits {
  RateLimits rates;
  PeerLimits peers;
  RepeatLimits repeats;
};

/// Thread-safe.
class DatagramGuard {
 public:
  using Time = core::TokenBucket::Time;  ///< of any clock that does not go back

  explicit DatagramGuard(const GuardLimits& limits = {})
      : rates_(limits.rates), peers_(limits.peers), repeats_(limits.repeats) {}

  /// What is for others alone says nothing about what Fast DDS here has seen.
  void set_own(const GuidPrefix& own);
  /// Who is a node of the run, but for this process: see repeats.h.
  void set_nodes(Repeats::Prefixes nodes);
  /// A writer of this process, of what nodes say to each other.
  void add_writer_of_nodes(std::uint32_t writer);
  void remove_writer_of_nodes(std::uint32_t writer);
  /// Nothing of it passes from now on, until it is forgiven.
  void shun(const GuidPrefix& process);
  void forgive(const GuidPrefix& process);

  struct Admitted {
    /// Datagrams that Fast DDS is to see first: what is better said otherwise.
    std::vector<MadeDatagram> before;
    std::size_t size = 0;  ///< of the datagram's begin, that Fast DDS may see; 0: nothing
    /// Fast DDS 2.9.1 must not see another one like it meanwhile, on another socket: what it keeps of whom it meets
    /// passes through variables that all threads share (SecurityManager's temporaries; mended in 2.9.2, #3373). Of two
    /// participants with keys, one would not be met, for ever.
    bool is_alone = false;
  };
  /// Changes `bytes`: what Fast DDS must not act on becomes padding.
  Admitted admit(std::span<std::uint8_t> bytes, Source source, Time now);
  Delivery& delivery() { return delivery_; }
  /// What this process is about to send, as it is to be sent; nothing: as it is.
  std::optional<std::vector<std::uint8_t>> note_sent(std::span<const std::uint8_t> bytes);

  GuardReport report() const;
  /// Sources of which something was refused for the first time since the last call.
  std::vector<GuardReport::Address> take_new_sources();
  std::vector<std::pair<GuidPrefix, Repeats::Answer>> take_new_askers();

 private:
  std::optional<Refusal> judge(const Findings& findings, std::span<const std::uint8_t> bytes, Source source, Time now,
                               Admitted& admitted);
  std::optional<Refusal> judge_whole(const Claim& claim, std::span<const std::uint8_t> bytes, Source source, Time now,
                                     Admitted& admitted);
  bool is_of_shunned(const Findings& findings, const GuidPrefix& sender) const;
  void answer_requests(Findings& findings, Source source, Time now);
  void refuse(Refusal why, Source source);

  Delivery delivery_;
  mutable std::mutex mutex_;
  std::optional<GuidPrefix> own_;
  SourceLimits rates_;
  PeerBook peers_;
  FragmentRequests fragment_requests_;
  Repeats repeats_;
  Repeats::Prefixes shunned_;
  GuardReport::Counts refused_{};
  std::uint64_t passed_ = 0;
  std::unordered_map<std::uint32_t, GuardReport::Address> addresses_;
  std::uint64_t of_others_ = 0;  ///< refused, of addresses beyond those that are told apart
  std::vector<std::uint32_t> new_addresses_;
};

}  // namespace aurasim::dds
