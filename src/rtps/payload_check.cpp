#include "rtps/payload_check.h"

namespace aurasim::rtps {
namespace {

using Result = std::optional<Refusal>;

enum class Payload : std::uint8_t { kUser, kParticipant, kEndpoint, kLiveliness, kHandshake, kUnknown };

Payload payload_of(std::uint32_t writer) {
  if (!is_built_in(writer)) return Payload::kUser;
  switch (writer) {
    case kParticipantWriter:
    case 0xff0101c2:
      return Payload::kParticipant;
    case 0x000002c2:
    case 0x000003c2:
    case 0x000004c2:
    case 0xff0003c2:
    case 0xff0004c2:
      return Payload::kEndpoint;
    case 0x000200c2:
    case 0xff0200c2:
      return Payload::kLiveliness;
    case 0x000201c3:
    case 0xff0202c3:
      return Payload::kHandshake;
    default:
      return Payload::kUnknown;
  }
}

/// Adds a claim about the participant or endpoint that the 16-octet key of discovery names.
void add_subject(Claim::Kind kind, const ListFindings& list, const GuidPrefix& destination, Findings& findings) {
  if (!list.subject) return;
  Claim claim;
  claim.kind = kind;
  claim.destination = destination;
  claim.guid = *list.subject;
  claim.lease_s = list.lease_s;
  findings.claims.push_back(claim);
}

Result check_discovery(Payload payload, WireCursor& body, const GuidPrefix& destination, Findings& findings) {
  const bool participant = payload == Payload::kParticipant;
  ListFindings list;
  if (Result refused =
          check_parameters(body, participant ? ListKind::kParticipant : ListKind::kEndpoint, list, findings)) {
    return refused;
  }
  if (!list.subject || list.subject->prefix == GuidPrefix{} || list.subject->entity == 0) return Refusal::kPayload;
  constexpr std::uint32_t kParticipantEntity = 0x1c1;
  if (participant && (list.lease_s == 0 || list.subject->entity != kParticipantEntity)) return Refusal::kPayload;
  add_subject(participant ? Claim::Kind::kParticipant : Claim::Kind::kEndpoint, list, destination, findings);
  return std::nullopt;
}

/// Reads a handshake: identities, keys, class and tokens. Returns whether it is well-formed.
bool is_handshake(WireCursor& body) {
  constexpr std::size_t kIdentities = 2 * 24 + 3 * 16, kMostTokens = 16, kLongestClass = 256;
  if (body.left() < kIdentities) return false;
  body.skip(kIdentities);
  if (!is_string(body, kLongestClass)) return false;
  const std::uint32_t tokens = body.u32();
  if (body.failed() || tokens > kMostTokens) return false;
  for (std::uint32_t i = 0; i < tokens; ++i) {
    if (!is_data_holder(body)) return false;
  }
  return true;
}

}  // namespace

bool introduces(std::uint32_t writer) {
  const Payload payload = payload_of(writer);
  return payload == Payload::kParticipant || payload == Payload::kHandshake;
}

std::optional<Refusal> check_payload(std::uint32_t writer, WireCursor& body, const GuidPrefix& destination,
                                     Findings& findings) {
  const Payload payload = payload_of(writer);
  findings.introduces = findings.introduces || introduces(writer);
  if (payload == Payload::kUnknown) return std::nullopt;  // no reader here receives it
  if (body.left() < 4) return Refusal::kPayload;
  body.skip(1);
  const std::uint8_t encapsulation = body.u8();
  body.skip(2);
  constexpr std::uint8_t kListBig = 2, kListLittle = 3;
  body.set_little((encapsulation & 1) != 0);
  if (payload == Payload::kUser) return std::nullopt;
  if (payload == Payload::kLiveliness) return body.left() >= 20 ? Result() : Refusal::kPayload;
  if (payload == Payload::kHandshake) return is_handshake(body) ? Result() : Refusal::kPayload;
  if (encapsulation != kListBig && encapsulation != kListLittle) return Refusal::kPayload;
  return check_discovery(payload, body, destination, findings);
}

void add_gone(std::uint32_t writer, const ListFindings& inline_qos, const GuidPrefix& destination, Findings& findings) {
  if (inline_qos.gone && payload_of(writer) == Payload::kEndpoint) {
    add_subject(Claim::Kind::kEndpointGone, inline_qos, destination, findings);
  }
}

}  // namespace aurasim::rtps
