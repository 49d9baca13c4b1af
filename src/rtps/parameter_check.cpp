#include "rtps/parameter_check.h"

#include <algorithm>

namespace aurasim::rtps {
namespace {

// Parameter ids: RTPS 2.2, table 9.13; DDS-XTYPES 1.3; DDS Security 1.1, section 7.4; from 0x8000 on eProsima's.
enum Pid : std::uint16_t {
  kPad = 0x0000,
  kSentinel = 0x0001,
  kParticipantLease = 0x0002,
  kTopicName = 0x0005,
  kTypeName = 0x0007,
  kDomainId = 0x000f,
  kProtocolVersion = 0x0015,
  kVendor = 0x0016,
  kReliability = 0x001a,
  kLiveliness = 0x001b,
  kDurability = 0x001d,
  kDurabilityService = 0x001e,
  kOwnership = 0x001f,
  kPresentation = 0x0021,
  kDeadline = 0x0023,
  kDestinationOrder = 0x0025,
  kPartition = 0x0029,
  kLifespan = 0x002b,
  kUserData = 0x002c,
  kGroupData = 0x002d,
  kTopicData = 0x002e,
  kUnicastLocator = 0x002f,
  kMulticastLocator = 0x0030,
  kDefaultUnicastLocator = 0x0031,
  kMetatrafficUnicastLocator = 0x0032,
  kMetatrafficMulticastLocator = 0x0033,
  kContentFilter = 0x0035,
  kHistory = 0x0040,
  kDefaultMulticastLocator = 0x0048,
  kParticipantGuid = 0x0050,
  kBuiltInEndpoints = 0x0058,
  kPropertyList = 0x0059,
  kEndpointGuid = 0x005a,
  kEntityName = 0x0062,
  kTypeId = 0x0069,
  kKeyHash = 0x0070,
  kStatusInfo = 0x0071,
  kTypeObject = 0x0072,
  kDataRepresentation = 0x0073,
  kTypeConsistency = 0x0074,
  kTypeInformation = 0x0075,
  kIdentityToken = 0x1001,
  kPermissionsToken = 0x1002,
  kEndpointSecurityInfo = 0x1004,
  kParticipantSecurityInfo = 0x1005,
  kIdentityStatusToken = 0x1006,
  kDomainTag = 0x4014,
  kPersistenceGuid = 0x8002,
  kDisablePositiveAcks = 0x8005,
  kDataSharing = 0x8006,
  kRelatedSample = 0x800f
};

constexpr std::size_t kLongestName = 256;
constexpr std::size_t kLongestPropertyText = 4096;
constexpr std::size_t kMostProperties = 64;
constexpr std::size_t kMostPartitions = 64;
/// Most stars in a pattern. Each `*` in a pattern that does not match multiplies the time of the C library's fnmatch().
/// Our patterns have two.
constexpr std::ptrdiff_t kMostStars = 4;
constexpr std::size_t kMostLocators = 32;
constexpr double kShortestLease_s = 0.05;

/// Reads a text with its end. `stars` returns the number of `*` in it.
bool is_string(WireCursor& cursor, std::size_t most, std::ptrdiff_t* stars) {
  const std::uint32_t length = cursor.u32();
  if (cursor.failed() || length == 0 || length > most || length > cursor.left()) return false;
  std::ptrdiff_t count = 0;
  for (std::size_t i = 0; i < length; ++i) {
    const std::uint8_t letter = cursor.peek(i);
    if ((letter == 0) != (i + 1 == length)) return false;
    count += letter == '*' ? 1 : 0;
  }
  if (stars != nullptr) *stars = count;
  cursor.skip(length);
  cursor.align();
  return true;
}

bool is_partition_list(WireCursor& value) {
  const std::uint32_t count = value.u32();
  if (value.failed() || count > kMostPartitions) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::ptrdiff_t stars = 0;
    if (!is_string(value, kLongestName, &stars) || stars > kMostStars) return false;
  }
  return value.left() == 0;
}

/// Reads a list of text properties; one of octet properties may follow.
bool is_property_list(WireCursor& value) {
  const std::uint32_t count = value.u32();
  if (value.failed() || count > kMostProperties) return false;
  for (std::uint32_t i = 0; i < 2 * count; ++i) {
    if (!is_string(value, kLongestPropertyText)) return false;
  }
  return true;
}

bool is_octet_sequence(WireCursor& cursor) {
  const std::uint32_t length = cursor.u32();
  if (cursor.failed() || length > cursor.left()) return false;
  cursor.skip(length);
  cursor.align();
  return true;
}

/// Reads a sequence of numbers of `size` octets each.
bool is_number_sequence(WireCursor& value, std::size_t size, std::size_t most) {
  const std::uint32_t count = value.u32();
  return !value.failed() && count <= most && count * size <= value.left();
}

bool is_locator(WireCursor& value) {
  if (value.left() != 24) return false;
  constexpr std::int32_t kUdpV4 = 1;
  const std::int32_t kind = value.i32();
  const std::uint32_t port = value.u32();
  return kind != kUdpV4 || port <= UINT16_MAX;
}

/// Reads a duration: seconds and their 2^-32. nullopt if it is negative. Infinity is a large number.
std::optional<double> duration_s(WireCursor& value) {
  const std::int32_t seconds = value.i32();
  const std::uint32_t fraction = value.u32();
  if (value.failed() || seconds < 0) return std::nullopt;
  return seconds + fraction * 0x1p-32;
}

bool is_kind(WireCursor& value, std::uint32_t first, std::uint32_t last) {
  const std::uint32_t kind = value.u32();
  return !value.failed() && kind >= first && kind <= last;
}

std::optional<WireGuid> guid_in(WireCursor& value) {
  WireGuid guid;
  guid.prefix = value.octets<GuidPrefix>();
  guid.entity = value.entity();
  return value.failed() ? std::nullopt : std::optional(guid);
}

/// True for parameters that Fast DDS would act on and that no run uses. Foreign type objects end the process that reads
/// them (eProsima/Fast-DDS #3296), filters are compiled and run in the writer, shared memory is off. Types are
/// distinguished by their names, and by the version in every message.
bool is_hidden(std::uint16_t pid, ListKind kind) {
  switch (pid) {
    case kTypeId:
    case kTypeObject:
    case kTypeInformation:
    case kContentFilter:
    case kDataSharing:
      return kind == ListKind::kEndpoint;
    // Hidden, because the key is computed from the sample; guarded_type.h bounds the number of keys.
    case kKeyHash:
      return kind == ListKind::kInlineQosOfSamples;
    default:
      return false;
  }
}

/// Checks one parameter of discovery. `value` spans all of it.
bool check_value(std::uint16_t pid, WireCursor value, ListKind kind, ListFindings& list, std::size_t& locators) {
  switch (pid) {
    case kParticipantLease: {
      const auto lease_s = duration_s(value);
      if (!lease_s || *lease_s < kShortestLease_s || *lease_s > kLongestLease_s) return false;
      list.lease_s = *lease_s;
      return true;
    }
    case kTopicName:
    case kTypeName:
    case kEntityName:
    case kDomainTag:
      return is_string(value, kLongestName);
    case kDurability:
      return is_kind(value, 0, 3);
    case kReliability:
      return is_kind(value, 1, 2) && duration_s(value).has_value();
    case kLiveliness:
      return is_kind(value, 0, 2) && duration_s(value).has_value();
    case kOwnership:
    case kDestinationOrder:
      return is_kind(value, 0, 1);
    case kPresentation:
      return is_kind(value, 0, 2);
    case kHistory:
      return is_kind(value, 0, 1) && value.left() >= 4;
    case kDeadline:
    case kLifespan:
      return duration_s(value).has_value();
    case kDurabilityService:
      return value.left() >= 28;
    case kPartition:
      return is_partition_list(value);
    case kUserData:
    case kGroupData:
    case kTopicData:
      return is_octet_sequence(value);
    case kUnicastLocator:
    case kMulticastLocator:
    case kDefaultUnicastLocator:
    case kDefaultMulticastLocator:
    case kMetatrafficUnicastLocator:
    case kMetatrafficMulticastLocator:
      return ++locators <= kMostLocators && is_locator(value);
    case kParticipantGuid:
    case kEndpointGuid:
    case kKeyHash: {
      const auto guid = guid_in(value);
      if (!guid) return false;
      const bool names_subject = pid != kParticipantGuid || kind == ListKind::kParticipant;
      if (!names_subject) return true;
      if (list.subject && *list.subject != *guid) return false;
      list.subject = guid;
      return true;
    }
    case kPersistenceGuid:
      return value.left() >= 16;
    case kPropertyList:
      return is_property_list(value);
    case kDataRepresentation:
      return is_number_sequence(value, 2, 16);
    case kDomainId:
    case kProtocolVersion:
    case kVendor:
    case kBuiltInEndpoints:
    case kTypeConsistency:
      return value.left() >= 4;
    case kIdentityToken:
    case kPermissionsToken:
    case kIdentityStatusToken:
      return is_data_holder(value);
    case kEndpointSecurityInfo:
    case kParticipantSecurityInfo:
      return value.left() >= 8;
    default:
      return true;
  }
}

bool check_inline(std::uint16_t pid, WireCursor value, ListFindings& list) {
  switch (pid) {
    case kKeyHash:
      list.subject = guid_in(value);
      return list.subject.has_value();
    case kStatusInfo:
      if (value.left() != 4) return false;
      list.gone = (value.peek(3) & 3) != 0;
      return true;
    case kRelatedSample:
      return value.left() >= 24;
    default:
      return true;
  }
}

}  // namespace

bool is_string(WireCursor& cursor, std::size_t most) { return is_string(cursor, most, nullptr); }

bool is_data_holder(WireCursor& cursor) {
  if (!is_string(cursor, kLongestName)) return false;
  const std::uint32_t texts = cursor.u32();
  if (cursor.failed() || texts > kMostProperties) return false;
  for (std::uint32_t i = 0; i < 2 * texts; ++i) {
    if (!is_string(cursor, kLongestPropertyText)) return false;
  }
  if (cursor.left() == 0) return true;
  const std::uint32_t binaries = cursor.u32();
  if (cursor.failed() || binaries > kMostProperties) return false;
  for (std::uint32_t i = 0; i < binaries; ++i) {
    if (!is_string(cursor, kLongestName) || !is_octet_sequence(cursor)) return false;
  }
  return true;
}

std::optional<Refusal> check_parameters(WireCursor& cursor, ListKind kind, ListFindings& list, Findings& findings) {
  const bool inline_qos = kind == ListKind::kInlineQos || kind == ListKind::kInlineQosOfSamples;
  std::size_t locators = 0;
  for (;;) {
    const std::size_t at = cursor.at();
    const std::uint16_t pid = cursor.u16();
    const std::uint16_t length = cursor.u16();
    if (cursor.failed()) return Refusal::kParameterList;
    if (pid == kSentinel) return std::nullopt;
    if (length % 4 != 0 || length > cursor.left()) return Refusal::kParameterList;
    const WireCursor value = cursor.part(length);
    if (is_hidden(pid, kind)) {
      findings.hidden_parameters.push_back(at);
    } else if (!(inline_qos ? check_inline(pid, value, list) : check_value(pid, value, kind, list, locators))) {
      return Refusal::kParameter;
    }
  }
}

}  // namespace aurasim::rtps
