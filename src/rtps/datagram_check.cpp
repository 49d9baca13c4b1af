#include "rtps/datagram_check.h"

#include <algorithm>
#include <bit>

#include "rtps/parameter_check.h"
#include "rtps/payload_check.h"
#include "rtps/wire_cursor.h"

namespace aurasim::rtps {
namespace {

using Result = std::optional<Refusal>;
constexpr Result kFine = std::nullopt;

// RTPS 2.2, table 9.2; DDS Security 1.1, table 19; the last one is eProsima's.
enum SubmessageId : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTimestamp = 0x09,
  kInfoSource = 0x0c,
  kInfoReplyIp4 = 0x0d,
  kInfoDestination = 0x0e,
  kInfoReply = 0x0f,
  kNackFrag = 0x12,
  kHeartbeatFrag = 0x13,
  kData = 0x15,
  kDataFrag = 0x16,
  kSecureBody = 0x30,
  kSecurePrefix = 0x31,
  kSecurePostfix = 0x32,
  kSecureRtpsPrefix = 0x33,
  kSecureRtpsPostfix = 0x34,
  kStatistics = 0x80
};

constexpr std::size_t kStatisticsBytes = 56;
constexpr std::size_t kCryptoHeaderBytes = 20, kMacBytes = 16, kReceiverMacBytes = 20;
constexpr std::uint32_t kLargestFragmentNumber = kLargestSample_B / kSmallestFragment_B;
constexpr std::size_t kMostLocators = 64;

bool is_sequence_number(std::uint64_t number) { return number >= 1 && number <= kLargestSequenceNumber; }

/// Checks one datagram from the front.
class Checker {
 public:
  Checker(std::span<const std::uint8_t> bytes, Findings& findings) : bytes_(bytes), findings_(findings) {}

  Result check() {
    findings_.clear();
    findings_.size = bytes_.size();
    if (Result refused = check_header()) return refused;
    std::size_t at = kHeaderBytes;
    for (std::size_t count = 0; at < bytes_.size(); ++count) {
      if (count == kMostSubmessages) return Refusal::kSubmessage;
      if (Result refused = check_next(at)) return refused;
    }
    return kFine;
  }

 private:
  Result check_header() {
    if (bytes_.size() < kHeaderBytes || bytes_[0] != 'R' || bytes_[1] != 'T' || bytes_[2] != 'P' || bytes_[3] != 'S' ||
        bytes_[4] != 2) {
      return Refusal::kHeader;
    }
    std::copy_n(bytes_.begin() + 8, source_.size(), source_.begin());
    return kFine;
  }

  /// Checks the submessage at `at` and moves `at` behind it.
  Result check_next(std::size_t& at) {
    if (bytes_.size() - at < 4) return Refusal::kLength;
    begin_ = at;
    const std::uint8_t id = bytes_[at];
    flags_ = bytes_[at + 1];
    WireCursor head(bytes_, at + 2, at + 4, (flags_ & 1) != 0);
    std::size_t length = head.u16();
    at += 4;
    last_ = length == 0 && id != kInfoTimestamp && id != kPad;
    if (last_) length = bytes_.size() - at;
    if (length > bytes_.size() - at) return Refusal::kLength;
    const std::size_t end = at + length;
    if (length % 4 != 0 && end != bytes_.size()) return Refusal::kLength;
    WireCursor body(bytes_, at, end, (flags_ & 1) != 0);
    at = end;
    return check_body(id, body);
  }

  Result check_body(std::uint8_t id, WireCursor& body) {
    switch (id) {
      case kPad:
        return kFine;
      case kAckNack:
        return check_ack_nack(body);
      case kHeartbeat:
        return check_heartbeat(body);
      case kGap:
        return check_gap(body);
      case kInfoTimestamp:
        return check_timestamp(body);
      case kInfoSource:
        if (body.left() != 20) return Refusal::kLength;
        body.skip(8);
        source_ = body.octets<GuidPrefix>();
        return kFine;
      case kInfoReplyIp4:
        return body.left() >= 8 ? kFine : Refusal::kLength;
      case kInfoReply:
        return check_locators(body);
      case kInfoDestination:
        return check_destination(body);
      case kNackFrag:
        return check_nack_frag(body);
      case kHeartbeatFrag:
        return check_heartbeat_frag(body);
      case kData:
        return check_data(body);
      case kDataFrag:
        return check_data_frag(body);
      case kSecurePrefix:
      case kSecureRtpsPrefix:
        return body.left() >= kCryptoHeaderBytes ? kFine : Refusal::kLength;
      case kSecureBody:
        return check_secure_body(body);
      case kSecurePostfix:
      case kSecureRtpsPostfix:
        return check_secure_postfix(body);
      case kStatistics:
        return check_statistics(body);
      default:
        return Refusal::kSubmessage;
    }
  }

  /// Checks the statistics with which Fast DDS ends every datagram. They are never passed to Fast DDS, because the code
  /// that evaluates them takes differences that must not be negative.
  Result check_statistics(const WireCursor& body) {
    if (last_ || body.left() != kStatisticsBytes || body.at() + body.left() != bytes_.size()) {
      return Refusal::kStatistics;
    }
    findings_.size = begin_;
    return kFine;
  }

  Result check_timestamp(WireCursor& body) {
    constexpr std::uint8_t kInvalidateFlag = 2;
    const bool valid = (flags_ & kInvalidateFlag) == 0;
    if (valid && body.left() < 8) return Refusal::kLength;
    timestamp_ = valid ? std::optional(body.u32_pair()) : std::nullopt;
    return kFine;
  }

  Result check_destination(WireCursor& body) {
    if (body.left() < destination_.size()) return Refusal::kLength;
    const auto prefix = body.octets<GuidPrefix>();
    if (prefix != GuidPrefix{}) destination_ = prefix;
    return kFine;
  }

  static Result check_locators(WireCursor& body) {
    const std::uint32_t count = body.u32();
    return !body.failed() && count <= kMostLocators && count * 24 <= body.left() ? kFine : Refusal::kLength;
  }

  /// Checks a number set: base, number of bits and the bits.
  static Result check_bits(WireCursor& body) {
    const std::uint32_t bits = body.u32();
    if (body.failed() || bits > kMostBits) return Refusal::kNumberSet;
    body.skip((bits + 31) / 32 * 4);
    return body.failed() ? Result(Refusal::kNumberSet) : kFine;
  }

  Request request_of(WireCursor& body) const {
    Request request;
    request.destination = destination_;
    const std::uint32_t reader = body.entity();
    request.reader = {source_, reader};
    request.writer = body.entity();
    request.at = begin_;
    request.goes_to_end = last_;
    return request;
  }

  /// Adds a request. `bits` is positioned at the number of bits.
  Result add_request(Request request, WireCursor bits, WireCursor& body) {
    if (Result refused = check_bits(body)) return refused;
    if (body.left() < 4) return Refusal::kLength;
    for (std::uint32_t left = bits.u32(); left > 0; left -= std::min(left, 32U)) {
      request.wanted += static_cast<std::uint32_t>(std::popcount(bits.u32()));
    }
    findings_.requests.push_back(request);
    return kFine;
  }

  Result check_ack_nack(WireCursor& body) {
    Request request = request_of(body);
    request.base = body.sequence_number();
    if (body.failed()) return Refusal::kLength;
    if (request.base > kLargestSequenceNumber) return Refusal::kSequenceNumber;
    return add_request(request, body, body);
  }

  static Result check_nack_frag(WireCursor& body) {
    body.skip(4);
    const std::uint32_t writer = body.entity();
    const std::uint64_t sequence = body.sequence_number();
    const std::uint32_t base = body.u32();
    if (body.failed()) return Refusal::kLength;
    if (!is_sequence_number(sequence)) return Refusal::kSequenceNumber;
    if (!is_built_in(writer) || base < 1 || base > kLargestFragmentNumber) return Refusal::kFragment;
    if (Result refused = check_bits(body)) return refused;
    return body.left() >= 4 ? kFine : Refusal::kLength;
  }

  static Result check_heartbeat_frag(WireCursor& body) {
    body.skip(4);
    const std::uint32_t writer = body.entity();
    const std::uint64_t sequence = body.sequence_number();
    const std::uint32_t last_fragment = body.u32();
    body.skip(4);
    if (body.failed()) return Refusal::kLength;
    if (!is_sequence_number(sequence)) return Refusal::kSequenceNumber;
    return is_built_in(writer) && last_fragment <= kLargestFragmentNumber ? kFine : Refusal::kFragment;
  }

  Claim claim_of(Claim::Kind kind, std::uint32_t writer) const {
    Claim claim;
    claim.kind = kind;
    claim.destination = destination_;
    claim.guid = {source_, writer};
    return claim;
  }

  Result check_heartbeat(WireCursor& body) {
    const std::uint32_t reader = body.entity();
    Claim claim = claim_of(Claim::Kind::kHeartbeat, body.entity());
    claim.reader = reader;
    claim.first = body.sequence_number();
    claim.last = body.sequence_number();
    body.skip(4);
    if (body.failed()) return Refusal::kLength;
    // For an empty history last is first - 1.
    if (!is_sequence_number(claim.first) || claim.last > kLargestSequenceNumber || claim.last + 1 < claim.first) {
      return Refusal::kSequenceNumber;
    }
    findings_.claims.push_back(claim);
    return kFine;
  }

  Result check_gap(WireCursor& body) {
    const std::uint32_t reader = body.entity();
    Claim claim = claim_of(Claim::Kind::kGap, body.entity());
    claim.reader = reader;
    claim.first = body.sequence_number();
    const std::uint64_t base = body.sequence_number();
    if (body.failed()) return Refusal::kLength;
    if (!is_sequence_number(claim.first) || !is_sequence_number(base) || base < claim.first) {
      return Refusal::kSequenceNumber;
    }
    claim.last = base - 1;
    findings_.claims.push_back(claim);
    return check_bits(body);
  }

  Result check_data(WireCursor& body) {
    constexpr std::uint8_t kInlineQosFlag = 2, kDataFlag = 4, kKeyFlag = 8;
    if ((flags_ & kDataFlag) != 0 && (flags_ & kKeyFlag) != 0) return Refusal::kPayload;
    body.skip(2);
    const std::uint16_t to_inline_qos = body.u16();
    const std::uint32_t reader = body.entity();
    const std::uint32_t writer = body.entity();
    const std::uint64_t sequence = body.sequence_number();
    if (body.failed() || to_inline_qos != 16) return Refusal::kLength;
    if (!is_sequence_number(sequence)) return Refusal::kSequenceNumber;
    const bool has_payload = (flags_ & kDataFlag) != 0;
    const bool is_of_run = !is_built_in(writer);
    ListFindings list;
    if ((flags_ & kInlineQosFlag) != 0) {
      const ListKind kind = is_of_run && has_payload ? ListKind::kInlineQosOfSamples : ListKind::kInlineQos;
      if (Result refused = check_parameters(body, kind, list, findings_)) return refused;
    }
    if ((has_payload || (flags_ & kKeyFlag) != 0) && body.left() == 0) return Refusal::kPayload;
    if (is_of_run) {
      Claim claim = claim_of(Claim::Kind::kData, writer);
      claim.reader = reader;
      claim.first = claim.last = sequence;
      claim.has_payload = has_payload;
      findings_.claims.push_back(claim);
      // Hidden, because the guard passes the end of an instance on as a gap.
      if (!has_payload) findings_.hide_submessage(begin_, last_);
    }
    if (has_payload) return check_payload(writer, body, destination_, findings_);
    add_gone(writer, list, destination_, findings_);
    return kFine;
  }

  Result check_data_frag(WireCursor& body) {
    constexpr std::uint8_t kInlineQosFlag = 2, kKeyFlag = 4;
    body.skip(2);
    const std::uint16_t to_inline_qos = body.u16();
    const std::uint32_t reader = body.entity();
    Claim claim = claim_of(Claim::Kind::kFragments, body.entity());
    claim.reader = reader;
    findings_.introduces = findings_.introduces || introduces(claim.guid.entity);
    claim.first = claim.last = body.sequence_number();
    claim.first_fragment = body.u32();
    claim.fragments = body.u16();
    claim.fragment_B = body.u16();
    claim.sample_B = body.u32();
    if (body.failed() || to_inline_qos != 28) return Refusal::kLength;
    if (!is_built_in(claim.guid.entity)) return Refusal::kFragment;  // messages of a run go in parts (messages/parts.h)
    if (!is_sequence_number(claim.first)) return Refusal::kSequenceNumber;
    if ((flags_ & kKeyFlag) != 0) return Refusal::kPayload;
    if ((flags_ & kInlineQosFlag) != 0) {
      ListFindings list;
      if (Result refused = check_parameters(body, ListKind::kInlineQosOfSamples, list, findings_)) return refused;
    }
    claim.payload = body.at();
    claim.payload_B = body.left();
    claim.timestamp = timestamp_;
    if (!fragments_fit(claim)) return Refusal::kFragment;
    // Hidden, because Fast DDS gets the whole sample in one piece (datagram_guard.h).
    findings_.hide_submessage(begin_, last_);
    findings_.claims.push_back(claim);
    return kFine;
  }

  static bool fragments_fit(const Claim& claim) {
    if (claim.sample_B < 1 || claim.sample_B > kLargestSample_B) return false;
    if (claim.fragment_B < kSmallestFragment_B) return false;
    const std::uint32_t all = (claim.sample_B + claim.fragment_B - 1) / claim.fragment_B;
    if (claim.first_fragment < 1 || claim.first_fragment > all || claim.fragments < 1) return false;
    if (claim.fragments > all - (claim.first_fragment - 1)) return false;
    const std::size_t offset = std::size_t{claim.first_fragment - 1} * claim.fragment_B;
    const std::size_t whole = std::size_t{claim.fragments} * claim.fragment_B;
    const std::size_t expected = std::min<std::size_t>(whole, claim.sample_B - offset);
    return claim.payload_B >= expected && claim.payload_B <= expected + 3;
  }

  /// Checks a secure body: length and octets. Lengths in DDS Security are big-endian.
  static Result check_secure_body(WireCursor& body) {
    body.set_little(false);
    const std::uint32_t length = body.u32();
    return !body.failed() && length <= body.left() ? kFine : Refusal::kLength;
  }

  static Result check_secure_postfix(WireCursor& body) {
    body.set_little(false);
    body.skip(kMacBytes);
    const std::uint32_t receivers = body.u32();
    return !body.failed() && receivers <= body.left() / kReceiverMacBytes ? kFine : Refusal::kLength;
  }

  std::span<const std::uint8_t> bytes_;
  Findings& findings_;
  GuidPrefix source_{}, destination_{};
  std::optional<std::uint64_t> timestamp_;
  std::size_t begin_ = 0;   ///< offset of the present submessage
  std::uint8_t flags_ = 0;  ///< flags of the present submessage
  bool last_ = false;       ///< the submessage extends to the datagram's end
};

}  // namespace

std::optional<Refusal> check_datagram(std::span<const std::uint8_t> bytes, Findings& findings) {
  return Checker(bytes, findings).check();
}

}  // namespace aurasim::rtps
