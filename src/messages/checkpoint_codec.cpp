#include "messages/checkpoint_codec.h"

#include "aurasim.h"
#include "messages/header_check.h"

namespace aurasim::messages {

void encode(const Checkpoint& checkpoint, wire::Checkpoint& out) {
  out.source(core::value_of(checkpoint.source));
  out.kind(static_cast<std::uint8_t>(checkpoint.kind));
  out.version(kProtocolVersion);
  out.generation(checkpoint.generation);
  out.stamp(checkpoint.step);
  out.octets().assign(checkpoint.octets.begin(), checkpoint.octets.end());
}

Decoded<Checkpoint> decode(const wire::Checkpoint& in, const Expected& expected) {
  if (const auto error = check_header(in, expected)) return *error;
  if (const auto error = check_source(in, expected)) return *error;
  if (in.kind() > static_cast<std::uint8_t>(Checkpoint::Kind::kOrders)) return WireError::kEnum;
  if (in.stamp() < 0) return WireError::kRange;
  return Checkpoint{core::RegionId{in.source()}, static_cast<Checkpoint::Kind>(in.kind()), in.generation(), in.stamp(),
                    std::string(in.octets().begin(), in.octets().end())};
}

}  // namespace aurasim::messages
