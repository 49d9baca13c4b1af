// Findings about a datagram (datagram_check.h): why it is dropped, or what it claims.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace aurasim::rtps {

/// Reasons to drop a datagram. Those before kRate follow from its bytes; those from kRate on depend on earlier
/// datagrams.
enum class Refusal : std::uint8_t {
  kHeader,      ///< too short, no RTPS, or not of version 2
  kSubmessage,  ///< a submessage of unknown kind, or too many of them
  kLength,      ///< a submessage does not fit, or is too short for its kind
  kStatistics,  ///< eProsima's statistics anywhere but at the end, or of a wrong length
  /// A sequence number below 1 or beyond kLargestSequenceNumber, or a range whose last is before its first.
  kSequenceNumber,
  kNumberSet,      ///< a number set with more than 256 bits, or shorter than it says
  kFragment,       ///< fragments of a run's messages, or such as do not fit their sample or contradict earlier ones
  kParameterList,  ///< a parameter that does not fit, or no end
  kParameter,      ///< a malformed string, locator, partition, duration, ...
  kPayload,        ///< a malformed discovery, liveliness or handshake payload
  kRate,           ///< more datagrams or bytes from one source than any peer sends
  kJump,           ///< sequence numbers that leave out too many
  kUnfinished,     ///< too many bytes of samples of which fragments are missing
  kTooMany,        ///< too many participants or endpoints
  kRepeat,   ///< a retransmission that a process outside the run asked for is withheld; the rest of the datagram passes
  kShunned,  ///< from a process that is shut out
};
inline constexpr std::size_t kRefusalCount = 16;
const char* name_of(Refusal refusal);

using GuidPrefix = std::array<std::uint8_t, 12>;
struct PrefixHash {
  std::size_t operator()(const GuidPrefix& prefix) const;
};

struct WireGuid {
  GuidPrefix prefix{};
  std::uint32_t entity = 0;  ///< entity id: its four octets, the first one in the highest bits
  auto operator<=>(const WireGuid&) const = default;
};

/// Claim of a submessage that can only be judged from earlier datagrams.
struct Claim {
  enum class Kind : std::uint8_t { kData, kHeartbeat, kGap, kFragments, kParticipant, kEndpoint, kEndpointGone };
  Kind kind{};
  GuidPrefix destination{};  ///< zeros: everybody
  WireGuid guid;             ///< id of the writer, or of the announced participant or endpoint
  std::uint64_t first = 0;   ///< sequence number of a sample, or the first of a heartbeat's range or a gap
  std::uint64_t last = 0;    ///< last sequence number of a heartbeat's range or a gap; first - 1: the range is empty
  std::uint32_t reader = 0;  ///< entity id of the addressed reader; 0: all readers
  bool has_payload = true;   ///< the sample carries data; without data it announces the end of its instance
  std::uint32_t sample_B = 0, fragment_B = 0;
  std::uint32_t first_fragment = 0, fragments = 0;  ///< number of the first fragment (from 1) and how many there are
  double lease_s = 0;                               ///< lease of an announced participant
  std::size_t payload = 0, payload_B = 0;           ///< offset and size of the fragments' payload in the datagram
  /// Timestamp of fragments: seconds in the high 32 bits, their fraction in the low ones.
  std::optional<std::uint64_t> timestamp;
};

/// A reader's acknowledgement or request: what it has of a writer, and what it wants retransmitted.
struct Request {
  GuidPrefix destination{};  ///< zeros: everybody
  WireGuid reader;
  std::uint32_t writer = 0;
  /// All samples before this number are acknowledged; 0: the reader has just joined.
  std::uint64_t base = 0;
  std::uint32_t wanted = 0;  ///< number of samples wanted
  std::size_t at = 0;        ///< offset of its submessage in the datagram
  bool goes_to_end = false;  ///< its submessage has length 0: it extends to the end of the datagram
};

/// Result of a check. Reused for the next datagram, to keep its memory.
struct Findings {
  std::size_t size = 0;  ///< number of leading bytes that Fast DDS may see; excludes eProsima's statistics at the end
  bool introduces = false;  ///< it introduces a process: participant discovery or a handshake
  std::vector<Claim> claims;
  std::vector<Request> requests;
  std::vector<std::size_t> hidden_parameters;   ///< offsets of parameter ids that Fast DDS must not act on
  std::vector<std::size_t> hidden_submessages;  ///< offsets of submessage ids that Fast DDS must not act on
  struct Acknowledgement {
    std::size_t at = 0;  ///< offset of the acknowledgement's submessage
    std::uint64_t base = 0;
    void write_over(std::span<std::uint8_t> submessage) const;
  };
  /// Acknowledgements to be rewritten: all samples before `base` are there.
  std::vector<Acknowledgement> acknowledgements;
  void clear();
  /// Hides the submessage that begins at `at`.
  void hide_submessage(std::size_t at, bool goes_to_end);
  /// Turns the hidden parameters and hidden submessages into padding, and rewrites the acknowledgements so that they
  /// ask for no retransmission. `bytes` is the datagram that was checked.
  void hide(std::span<std::uint8_t> bytes) const;
};

inline constexpr std::size_t kHeaderBytes = 20;
inline constexpr std::uint64_t kLargestSequenceNumber = std::uint64_t{1} << 40;
/// Largest sample of discovery and handshakes that is accepted in fragments: a description of an endpoint has some kB.
inline constexpr std::uint32_t kLargestSample_B = 64U << 10;
/// Smallest fragment size that is accepted. Fast DDS and CycloneDDS make fragments larger than 1 kB on any link.
inline constexpr std::uint32_t kSmallestFragment_B = 256;
/// Largest size of a set of sequence or fragment numbers, bits.
inline constexpr std::uint32_t kMostBits = 256;
inline constexpr std::size_t kMostSubmessages = 512;
/// Longest lease that is accepted, s. A participant that announces a longer one is refused, because it would stay
/// remembered too long after it falls silent.
inline constexpr double kLongestLease_s = 3600;

/// True for built-in endpoints: discovery, liveliness and handshakes, which carry no messages of a run.
inline bool is_built_in(std::uint32_t entity) { return (entity & 0xc0U) == 0xc0U; }
/// The writer by which a participant announces itself.
inline constexpr std::uint32_t kParticipantWriter = 0x000100c2;

}  // namespace aurasim::rtps
