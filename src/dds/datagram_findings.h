// What is found in a datagram (datagram_check.h): why it is dropped, or what it claims.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace aurasim::dds {

/// Why a datagram is dropped. The first ones follow from its bytes, those from kRate on from what came before it.
enum class Refusal : std::uint8_t {
  kHeader,          ///< too short, no RTPS, or not of version 2
  kSubmessage,      ///< of an unknown kind, or too many
  kLength,          ///< a submessage does not fit, or is too short for its kind
  kStatistics,      ///< eProsima's statistics anywhere but at the end, or of a wrong length
  kSequenceNumber,  ///< below 1, beyond kLargestSequenceNumber, or last before first
  kNumberSet,       ///< more than 256 bits, or bits that are not there
  kFragment,        ///< fragments that do not fit their sample, or not those that came before
  kParameterList,   ///< a parameter that does not fit, or no end
  kParameter,       ///< a string, locator, partition, duration, ... that is not one
  kPayload,         ///< discovery, liveliness or handshake that is not one
  kRate,            ///< more from one source than any peer sends
  kJump,            ///< sequence numbers that leave out too many
  kUnfinished,      ///< too many bytes of samples of which parts are missing
  kTooMany,         ///< participants or endpoints
  kRepeat,          ///< asked for by a process that is no node, and not answered; the rest of the datagram passes
  kShunned,         ///< of a process that is not listened to any more
};
inline constexpr std::size_t kRefusalCount = 16;
const char* name_of(Refusal refusal);

using GuidPrefix = std::array<std::uint8_t, 12>;
struct PrefixHash {
  std::size_t operator()(const GuidPrefix& prefix) const;
};

struct WireGuid {
  GuidPrefix prefix{};
  std::uint32_t entity = 0;  ///< its four octets, the first one highest
  bool operator==(const WireGuid&) const = default;
};

/// What a submessage says that only its past can judge.
struct Claim {
  enum class Kind : std::uint8_t { kData, kHeartbeat, kGap, kFragments, kParticipant, kEndpoint, kEndpointGone };
  Kind kind{};
  GuidPrefix destination{};  ///< zeros: everybody
  WireGuid guid;             ///< of the writer; of the participant or endpoint that is announced
  std::uint64_t first = 0;   ///< sequence number: of a sample, of a heartbeat's range, of a gap
  std::uint64_t last = 0;    ///< sequence number: of a heartbeat's range, of a gap; first - 1: it has none
  std::uint32_t reader = 0;  ///< whom it is for; 0: all
  bool has_payload = true;   ///< of a sample; one without says that its instance has ended
  std::uint32_t sample_B = 0, fragment_B = 0;
  std::uint32_t first_fragment = 0, fragments = 0;  ///< from 1
  double lease_s = 0;                               ///< of a participant
  std::size_t payload = 0, payload_B = 0;           ///< where in the datagram fragments are
  std::optional<std::uint64_t> timestamp;           ///< of fragments: seconds, and in 32 bits their fraction
};

/// A reader says what it has of a writer, and what it would like to be sent again.
struct Request {
  GuidPrefix destination{};  ///< zeros: everybody
  WireGuid reader;
  std::uint32_t writer = 0;
  bool of_fragments = false;  ///< of one sample
  std::uint64_t base = 0;     ///< all samples before it are acknowledged; 0: it has just come. Not of fragments
  std::uint32_t wanted = 0;   ///< samples or fragments
  std::size_t at = 0;         ///< where its submessage begins
  bool goes_to_end = false;   ///< it has no length
};

/// Reused from datagram to datagram.
struct Findings {
  std::size_t size = 0;     ///< how much of the datagram Fast DDS may see: without eProsima's statistics at its end
  bool introduces = false;  ///< it says who somebody is: a participant's discovery, or a handshake
  std::vector<Claim> claims;
  std::vector<Request> requests;
  std::vector<std::size_t> hidden_parameters;   ///< offsets of parameter ids that Fast DDS must not act on
  std::vector<std::size_t> hidden_submessages;  ///< offsets of submessage ids, likewise
  struct Acknowledgement {
    std::size_t at = 0;  ///< where an acknowledgement's submessage begins
    std::uint64_t base = 0;
    void write_over(std::span<std::uint8_t> submessage) const;
  };
  std::vector<Acknowledgement> acknowledgements;  ///< that are to say that all before `base` is there
  void clear();
  /// That begins at `at`.
  void hide_submessage(std::size_t at, bool goes_to_end);
  /// Makes the first two padding; acknowledgements want nothing. `bytes` is the datagram that was checked.
  void hide(std::span<std::uint8_t> bytes) const;
};

inline constexpr std::size_t kHeaderBytes = 20;
inline constexpr std::uint64_t kLargestSequenceNumber = std::uint64_t{1} << 40;
/// The hand-off of a whole scene (10,000 bodies with contacts) has some 20 MB.
inline constexpr std::uint32_t kLargestSample_B = 64U << 20;
/// The smallest that Fast DDS and CycloneDDS make on any link are larger than 1 kB.
inline constexpr std::uint32_t kSmallestFragment_B = 256;
/// Of a set of sequence or fragment numbers.
inline constexpr std::uint32_t kMostBits = 256;
inline constexpr std::size_t kMostSubmessages = 512;
/// Participants that stay remembered for longer than this after their last word are not taken in, s.
inline constexpr double kLongestLease_s = 3600;

/// Discovery, liveliness and handshakes: what participants say of themselves, not what a run says.
inline bool is_built_in(std::uint32_t entity) { return (entity & 0xc0U) == 0xc0U; }
/// The writer by which a participant announces itself.
inline constexpr std::uint32_t kParticipantWriter = 0x000100c2;

}  // namespace aurasim::dds
